// The parser of specs, seeds and durations.
#include "core/spec.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"

namespace isoline {
namespace {

// Where the text in double quotes that begins at `begin` ends: past its closing quote.
std::size_t end_of_quoted(std::string_view text, std::size_t begin) {
  std::size_t at = begin + 1;
  while (at < text.size() && text[at] != '"') at += text[at] == '\\' ? 2 : 1;
  require(at < text.size(), [&] { return fmt::format("'{}' leaves a quote open", text); });
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
    require(depth >= 0,
            [&] { return fmt::format("'{}' closes a bracket that it did not open", text); });
    if (letter == separator && depth == 0)
      parts.emplace_back();
    else
      parts.back() += text.substr(at, end - at);
    at = end;
  }
  require(depth == 0, [&] { return fmt::format("'{}' leaves a bracket open", text); });
  return parts;
}

std::string trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\n");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\n") - first + 1));
}

// A value as it is meant: a JSON string where it stands in double quotes, else as it is written.
std::string unquoted(const std::string& value) {
  if (!value.starts_with('"')) return value;
  return parse_json(value, "the value " + value).get<std::string>();
}

// All specs that `name` makes with one more option, a value each.
std::vector<Spec> crossed(const std::vector<Spec>& specs, const std::string& key,
                          const std::vector<std::string>& values) {
  std::vector<Spec> all;
  for (const Spec& spec : specs)
    for (const std::string& value : values) {
      all.push_back(spec);
      all.back().options.emplace_back(key, unquoted(trim(value)));
    }
  return all;
}

std::vector<Spec> expand(const std::string& text) {
  const auto open = text.find('[');
  std::vector<Spec> specs{{.name = trim(text.substr(0, open)), .options = {}}};
  require(!specs[0].name.empty(), [&] { return fmt::format("'{}' names nothing", text); });
  if (open == std::string::npos) return specs;
  require(text.ends_with(']'), [&] { return fmt::format("'{}' does not end with ]", text); });
  const std::string inner = text.substr(open + 1, text.size() - open - 2);
  if (trim(inner).empty()) return specs;
  for (const std::string& option : split(inner, ',')) {
    const auto equals = option.find('=');
    require(equals != std::string::npos,
            [&] { return fmt::format("'{}' in '{}' is no key=value", option, text); });
    specs = crossed(specs, trim(option.substr(0, equals)), split(option.substr(equals + 1), '|'));
  }
  return specs;
}

template <class T>
T parse_number(std::string_view text, std::string_view whole, const char* expected) {
  T value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  require(error == std::errc() && stop == text.data() + text.size(),
          [&] { return fmt::format("expected {}, got '{}'", expected, whole); });
  return value;
}

}  // namespace

std::vector<Spec> parse_specs(std::string_view text) {
  std::vector<Spec> all;
  for (const std::string& part : split(text, ','))
    for (Spec& spec : expand(trim(part))) all.push_back(std::move(spec));
  return all;
}

Spec parse_spec(std::string_view text) {
  const std::vector<Spec> specs = parse_specs(text);
  require(specs.size() == 1, [&] { return fmt::format("expected one component, got '{}'", text); });
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
    require(!options.contains(key),
            [&] { return fmt::format("{}: {} is given twice", spec.name, key); });
    options.set(key, value);
  }
  return options;
}

std::string name_of_spec(std::string_view spec) {
  return std::string(spec.substr(0, spec.find('[')));
}

std::vector<std::uint64_t> parse_seeds(std::string_view text) {
  constexpr const char* kExpected = "seeds such as 5 (0 to 4), 0..9 or =5";
  constexpr std::uint64_t kMost = 1'000'000;
  std::vector<std::uint64_t> seeds;
  const auto number = [&](std::string_view part) {
    return parse_number<std::uint64_t>(part, text, kExpected);
  };
  for (const std::string& part : split(text, ',')) {
    const auto dots = part.find("..");
    std::uint64_t first = 0, last = 0;
    if (part.starts_with('=')) {
      first = last = number(std::string_view(part).substr(1));
    } else if (dots != std::string::npos) {
      first = number(std::string_view(part).substr(0, dots));
      last = number(std::string_view(part).substr(dots + 2));
    } else {
      const std::uint64_t count = number(part);
      require(count > 0, "the number of seeds must be positive, got 0");
      last = count - 1;
    }
    require(first <= last && last - first < kMost, [&] {
      return fmt::format("seeds must rise and be at most a million, got '{}'", text);
    });
    for (std::uint64_t seed = first; seed <= last; ++seed) seeds.push_back(seed);
  }
  return seeds;
}

double parse_duration(std::string_view text) {
  const std::pair<std::string_view, double> units[] = {
      {"ms", 1e-3}, {"s", 1}, {"min", 60}, {"m", 60}, {"h", 3600}};
  std::string_view amount = text;
  double unit = 1;
  for (const auto& [suffix, seconds] : units)
    if (text.ends_with(suffix)) {
      amount = text.substr(0, text.size() - suffix.size());
      unit = seconds;
      break;
    }
  const double seconds = unit * parse_number<double>(amount, text, "a time such as 10s, 2m or 1h");
  require(seconds > 0 && std::isfinite(seconds),
          [&] { return fmt::format("a time must be positive, got '{}'", text); });
  return seconds;
}

}  // namespace isoline
