// The parser of specs, seeds and durations.
#include "core/spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/seeds.h"
#include "core/text.h"

namespace isoline {
namespace {

// Where the text in double quotes that begins at `begin` ends: past its closing quote.
std::size_t end_of_quoted(std::string_view text, std::size_t begin) {
  std::size_t at = begin + 1;
  while (at < text.size() && text[at] != '"') at += text[at] == '\\' ? 2 : 1;
  require(at < text.size(), [&] { return fmt::format("'{}' has an unclosed quote", text); });
  return at + 1;
}

// Splits at `separator` outside of any bracket and of text in double quotes.
std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts{""};
  int depth = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char letter = text[at];
    const std::size_t end = letter == '"' ? end_of_quoted(text, at) : at + 1;
    depth += (letter == '[') - (letter == ']');
    require(depth >= 0, [&] { return fmt::format("'{}' has a ] without a [", text); });
    if (letter == separator && depth == 0)
      parts.emplace_back();
    else
      parts.back() += text.substr(at, end - at);
    at = end;
  }
  require(depth == 0, [&] { return fmt::format("'{}' has a [ without a ]", text); });
  return parts;
}

std::string trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\n");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\n") - first + 1));
}

// Without a zero byte, which ends a text for the system and in the message that would name it.
std::string clean(std::string_view text) {
  require(text.find('\0') == text.npos, "a specification must not contain a zero byte");
  return valid_utf8(text);
}

// A value as it is meant: a JSON string where it stands in double quotes, else as it is written.
std::string unquoted(const std::string& value) {
  if (!value.starts_with('"')) return value;
  return clean(parse_json(value, "the value " + value).get<std::string>());
}

// A name and its options, each with all of its values.
struct Sweep {
  std::string name;
  std::vector<std::pair<std::string, std::vector<std::string>>> options;
};

Sweep sweep_of(const std::string& text) {
  const auto open = text.find('[');
  Sweep sweep{.name = trim(text.substr(0, open)), .options = {}};
  require(!sweep.name.empty(), [&] { return fmt::format("'{}' has no name", text); });
  if (open == std::string::npos) return sweep;
  require(text.ends_with(']'), [&] { return fmt::format("'{}' does not end with ]", text); });
  const std::string inner = text.substr(open + 1, text.size() - open - 2);
  if (trim(inner).empty()) return sweep;
  for (const std::string& option : split(inner, ',')) {
    const auto equals = option.find('=');
    require(equals != std::string::npos, [&] {
      return fmt::format("'{}' in '{}' must have the form option=value", option, text);
    });
    std::vector<std::string> values = split(option.substr(equals + 1), '|');
    for (std::string& value : values) value = unquoted(trim(value));
    sweep.options.emplace_back(trim(option.substr(0, equals)), std::move(values));
  }
  return sweep;
}

std::vector<Sweep> sweeps_of(std::string_view text) {
  std::vector<Sweep> sweeps;
  for (const std::string& part : split(clean(text), ',')) sweeps.push_back(sweep_of(trim(part)));
  return sweeps;
}

std::uint64_t settings_of(const Sweep& sweep) {
  std::uint64_t count = 1;
  for (const auto& [key, values] : sweep.options) count = product_of(count, values.size());
  return count;
}

// "1,000 of xi × 1,000 of phi"
std::string factors_of(const Sweep& sweep) {
  std::string text;
  for (const auto& [key, values] : sweep.options)
    if (values.size() > 1)
      text += fmt::format("{}{} of {}", text.empty() ? "" : " × ", count_text(values.size()), key);
  return text;
}

void require_few(const std::vector<Sweep>& sweeps, std::uint64_t most) {
  std::uint64_t count = 0;
  const Sweep* largest = nullptr;
  for (const Sweep& sweep : sweeps) {
    count = sum_of(count, settings_of(sweep));
    if (!largest || settings_of(sweep) > settings_of(*largest)) largest = &sweep;
  }
  require(count <= most, [&] {
    return fmt::format("{} settings are more than {}: {} alone has {} ({})", count_text(count),
                       count_text(most), largest->name, count_text(settings_of(*largest)),
                       factors_of(*largest));
  });
}

// Every setting; the values of the last option change fastest.
void expand(const Sweep& sweep, std::vector<Spec>& specs) {
  const std::size_t first = specs.size();
  specs.push_back({.name = sweep.name, .options = {}});
  for (const auto& [key, values] : sweep.options) {
    std::vector<Spec> crossed;
    for (std::size_t i = first; i < specs.size(); ++i)
      for (const std::string& value : values)
        crossed.emplace_back(specs[i]).options.emplace_back(key, value);
    specs.resize(first);
    std::ranges::move(crossed, std::back_inserter(specs));
  }
}

template <class T>
T parse_number(std::string_view text, std::string_view whole, const char* expected) {
  T value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  require(error == std::errc() && stop == text.data() + text.size(),
          [&] { return fmt::format("expected {}, got '{}'", expected, whole); });
  return value;
}

using SeedSpan = std::pair<std::uint64_t, std::uint64_t>;  // the first and the last

std::uint64_t pair_of(std::uint64_t instance, std::uint64_t start) {
  require(instance < kPairLimit && start < kPairLimit,
          "the numbers of instances and starts must be below 1,000");
  return seed_of(instance, start);
}

SeedSpan span_of(std::string_view part, std::string_view whole) {
  const auto number = [&](std::string_view digits) {
    return parse_number<std::uint64_t>(
        digits, whole,
        "a number of seeds (5 means seeds 0 to 4), a range (0..9), one seed (=5) or instance:start "
        "(2:1)");
  };
  const bool is_one = part.starts_with('=');
  const std::string_view one = part.substr(is_one ? 1 : 0);
  const auto colon = one.find(':');
  if (is_one || colon != std::string_view::npos) {
    const std::uint64_t seed =
        colon == std::string_view::npos
            ? number(one)
            : pair_of(number(one.substr(0, colon)), number(one.substr(colon + 1)));
    return {seed, seed};
  }
  const auto dots = part.find("..");
  if (dots == std::string_view::npos) {
    const std::uint64_t count = number(part);
    require(
        count > 0,
        "the number of seeds, instances or starts must be at least 1, got 0; for only one, with "
        "the number 0, write 1");
    return {0, count - 1};
  }
  const SeedSpan span{number(part.substr(0, dots)), number(part.substr(dots + 2))};
  if (span.first > span.second)
    throw UsageError(
        fmt::format("the first number of a range must not exceed the last, got '{}'", whole));
  return span;
}

}  // namespace

std::vector<SweepSize> sweep_sizes(std::string_view text) {
  std::vector<SweepSize> sizes;
  for (const Sweep& sweep : sweeps_of(text)) sizes.push_back({sweep.name, settings_of(sweep)});
  return sizes;
}

std::vector<Spec> parse_specs(std::string_view text, std::uint64_t most) {
  const std::vector<Sweep> sweeps = sweeps_of(text);
  require_few(sweeps, most);
  std::vector<Spec> all;
  for (const Sweep& sweep : sweeps) expand(sweep, all);
  return all;
}

Spec parse_spec(std::string_view text) {
  const std::vector<Spec> specs = parse_specs(text);
  require(specs.size() == 1,
          [&] { return fmt::format("expected one problem or optimizer, got '{}'", text); });
  return specs[0];
}

std::string quoted(const std::string& value) {
  const auto is_one = [&](char separator) { return split(value, separator).size() == 1; };
  try {
    const bool is_whole = !value.empty() && !value.starts_with('"') && trim(value) == value;
    if (is_whole && is_one(',') && is_one('|')) return value;
  } catch (const UsageError&) {  // it opens what it does not close
  }
  return json_text(value);
}

OptionValues options_of(const Spec& spec) {
  OptionValues options;
  for (const auto& [key, value] : spec.options) {
    const std::string name(option_name(key));
    require(!options.contains(name), [&] {
      return fmt::format("{}: {} is set twice{}", spec.name, name,
                         key == name ? "" : " (" + key + " is another name of it)");
    });
    options.set(name, value);
  }
  return options;
}

std::string name_of_spec(std::string_view spec) {
  return std::string(spec.substr(0, spec.find('[')));
}

std::vector<std::uint64_t> parse_seeds(std::string_view text, std::uint64_t most) {
  std::vector<SeedSpan> spans;
  std::uint64_t count = 0;
  for (const std::string& part : split(clean(text), ',')) {
    spans.push_back(span_of(part, text));
    count = sum_of(count, sum_of(spans.back().second - spans.back().first, 1));
  }
  require(count <= most, [&] {
    return fmt::format("'{}' lists {} seeds, instances or starts; at most {} are allowed", text,
                       count_text(count), count_text(most));
  });
  std::vector<std::uint64_t> seeds;
  for (const auto& [first, last] : spans)
    for (std::uint64_t i = 0; i <= last - first; ++i)
      seeds.push_back(seed_of(instance_of(first + i), start_of(first + i)));
  return seeds;
}

std::vector<std::uint64_t> crossed_seeds(std::string_view instances, std::string_view starts) {
  if (instances.empty()) instances = "=0";
  if (starts.empty()) starts = "=0";
  std::vector<std::uint64_t> seeds;
  for (const std::uint64_t instance : parse_seeds(instances, kPairLimit))
    for (const std::uint64_t start : parse_seeds(starts, kPairLimit))
      seeds.push_back(pair_of(instance, start));
  return seeds;
}

double parse_duration(std::string_view given) {
  const std::string text = clean(given);
  const std::pair<std::string_view, double> units[] = {
      {"ms", 1e-3}, {"s", 1}, {"min", 60}, {"m", 60}, {"h", 3600}};
  std::string_view amount = text;
  double unit = 1;
  for (const auto& [suffix, seconds] : units)
    if (text.ends_with(suffix)) {
      amount.remove_suffix(suffix.size());
      unit = seconds;
      break;
    }
  const double seconds = unit * parse_number<double>(amount, text, "a time such as 10s, 2m or 1h");
  require(seconds > 0 && seconds <= kMostSeconds, [&] {
    return fmt::format("a time must be above 0 and at most {} s, got '{}'", kMostSeconds, text);
  });
  return seconds;
}

}  // namespace isoline
