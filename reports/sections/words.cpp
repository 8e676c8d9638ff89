// Writes sentences, figures, names and commands.
#include "reports/sections/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>
#include <stdexcept>

#include "core/results/statistics.h"
#include "core/seeds.h"
#include "core/shell.h"
#include "core/spec.h"
#include "reports/sections/sections.h"

namespace isoline::reports {

std::string_view embedded_words();  // reports/words/*.txt

namespace {

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(' ') + 1 - first));
}

std::vector<std::string> trimmed_parts(const std::string& text, char between) {
  std::vector<std::string> parts;
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, between);) parts.push_back(trimmed(part));
  return parts;
}

[[noreturn]] void reject(std::string_view key, const std::string& why) {
  throw std::logic_error(fmt::format("reports/words: {}: {}", key, why));
}

// The form after the name in a placeholder: "", ":.2f" or "|one|many".
std::string written(const Value& value, const std::string& form) {
  if (form.starts_with('|')) {
    const std::size_t middle = form.find('|', 1);
    const bool is_one =
        std::visit([](const auto& one) { return fmt::format("{}", one) == "1"; }, value);
    return is_one ? form.substr(1, middle - 1) : form.substr(middle + 1);
  }
  if (const Real* real = std::get_if<Real>(&value); real != nullptr && form.empty())
    return figure(*real);
  return std::visit(
      [&](const auto& one) { return fmt::format(fmt::runtime("{" + form + "}"), one); }, value);
}

// The part of a key, which may be absent.
std::string part_of(std::string_view key, const char* part, const std::vector<Value>& values) {
  const auto found = all_sentences().find(fmt::format("{}.{}", key, part));
  if (found == all_sentences().end()) return "";
  return filled(found->first, found->second.names.empty() ? std::vector<Value>() : values);
}

}  // namespace

const std::map<std::string, Sentence, std::less<>>& all_sentences() {
  static const auto all = [] {
    std::map<std::string, Sentence, std::less<>> sentences;
    std::istringstream lines{std::string(embedded_words())};
    std::string above, key;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#') continue;
      if (line[0] == ' ') {
        sentences[key].text += " " + trimmed(line);
        continue;
      }
      const std::size_t colon = line.find(':'), open = std::min(line.find('('), colon);
      const bool is_part = line[0] == '.';
      key = (is_part ? above : "") + line.substr(0, open);
      Sentence sentence{is_part ? sentences[above].names : std::vector<std::string>(),
                        trimmed(std::string_view(line).substr(colon + 1))};
      if (open < colon)
        sentence.names = trimmed_parts(line.substr(open + 1, colon - open - 2), ',');
      if (!is_part) above = key;
      if (!sentences.emplace(key, std::move(sentence)).second) reject(key, "stands there twice");
    }
    return sentences;
  }();
  return all;
}

std::string filled(std::string_view key, const std::vector<Value>& values) {
  const auto found = all_sentences().find(key);
  if (found == all_sentences().end()) reject(key, "there is no such key");
  const auto& [names, text] = found->second;
  if (names.size() != values.size())
    reject(key, fmt::format("{} names and {} values", names.size(), values.size()));
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = std::min(text.find('{', at), text.size());
    out += text.substr(at, open - at);
    if (open == text.size()) break;
    const std::size_t close = text.find('}', open);
    const std::string inner = text.substr(open + 1, close - open - 1);
    const std::size_t end = std::min(inner.find_first_of(":|"), inner.size());
    const auto name = std::ranges::find(names, inner.substr(0, end));
    if (close == std::string::npos || name == names.end())
      reject(key, fmt::format("\"{}\" is not one of its names", inner));
    out += written(values[static_cast<std::size_t>(name - names.begin())], inner.substr(end));
    at = close + 1;
  }
  return out;
}

Table table_filled(std::string_view key, const std::vector<Value>& values) {
  return {.id = std::string(key),
          .title = part_of(key, "title", values),
          .caption = part_of(key, "caption", values),
          .columns = trimmed_parts(part_of(key, "columns", values), '|'),
          .meanings = trimmed_parts(part_of(key, "meanings", values), '|'),
          .align = part_of(key, "align", values)};
}

Plot plot_filled(std::string_view key, const std::vector<Value>& values) {
  return {.id = std::string(key),
          .title = part_of(key, "title", values),
          .caption = part_of(key, "caption", values),
          .x_label = part_of(key, "x", values),
          .y_label = part_of(key, "y", values)};
}

Section section_filled(std::string_view key, const std::vector<Value>& values) {
  return {.id = std::string(key),
          .title = part_of(key, "title", values),
          .lead = part_of(key, "lead", values),
          .otherwise = part_of(key, "otherwise", values)};
}

namespace {

// "1.2e-05" -> "1.2e-5".
std::string without_idle_zeros(std::string text) {
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  std::size_t digits = e + 2;  // after the sign
  while (digits + 1 < text.size() && text[digits] == '0') text.erase(digits, 1);
  if (text[e + 1] == '+') text.erase(e + 1, 1);
  return text;
}

// Four significant digits, "1.200e-04" without the zeros that say nothing: "1.2e-04".
std::string scientific(Real value) {
  const std::string text = fmt::format("{:.3e}", value);
  const std::size_t e = text.find('e'), last = text.find_last_not_of('0', e - 1);
  return text.substr(0, last + (text[last] == '.' ? 0 : 1)) + text.substr(e);
}

}  // namespace

std::string figure(Real value) {
  constexpr Real kInFull = 1e7;
  if (std::isfinite(value) && std::abs(value) < kInFull && value == std::round(value))
    return fmt::format("{:.0f}", std::abs(value) == 0 ? 0.0 : value);
  constexpr Real kScientificBelow = 1e-3;  // 1.842e-4 is shorter than 0.0001842
  const bool is_tiny = std::abs(value) < kScientificBelow;
  std::string text = fmt::format("{:.4g}", value);
  if (is_tiny && text.find('e') == std::string::npos) text = scientific(value);
  return without_idle_zeros(std::move(text));
}

std::string milliseconds(Real seconds) {
  constexpr Real kWhole = 1000;
  const Real value = 1e3 * seconds;
  if (value == kNever) return "✗";
  return value < kWhole ? without_idle_zeros(fmt::format("{:.3g}", value))
                        : fmt::format("{:.0f}", value);
}

std::string exact_figure(Real value) {
  if (std::isfinite(value) && std::abs(value) < 1e15 && value == std::round(value))
    return fmt::format("{:.0f}", value);
  return without_idle_zeros(fmt::format("{}", value));
}

std::string reached_figure(Real value) { return value == kNever ? "✗" : figure(value); }

std::string range_figure(const Spread& spread, std::string (*written)(Real)) {
  if (spread.n <= 1 || spread.low == spread.high) return "";
  return fmt::format("{}–{}", written(spread.low), written(spread.high));
}

std::string figure(const Spread& spread) {
  if (spread.n == 0) return "";
  const std::string range = range_figure(spread, reached_figure);
  return reached_figure(spread.median) + (range.empty() ? "" : fmt::format(" ({})", range));
}

std::string percent(Real share) { return fmt::format("{:.0f} %", 100 * share); }

std::string spec_without(std::string_view text, std::string_view option) {
  const Spec spec = parse_spec(text);
  std::string rest;
  for (const auto& [name, value] : spec.options)
    if (name != option)
      rest += fmt::format("{}{}={}", rest.empty() ? "" : ",", name, quoted(value));
  return rest.empty() ? spec.name : fmt::format("{}[{}]", spec.name, rest);
}

std::string shown_spec(std::string_view spec) {
  constexpr std::size_t kLong = 7;  // "0.01389" still stands in full
  std::string out;
  for (std::size_t i = 0; i < spec.size();) {
    const std::size_t end = std::min(spec.find_first_not_of("0123456789.e-", i), spec.size());
    const std::string word(spec.substr(i, end - i));
    const bool is_value = i > 0 && spec[i - 1] == '=';
    const bool is_long = word.size() > kLong || word.find("e-0") != std::string::npos;
    char* rest = nullptr;
    const Real value = is_value && is_long ? std::strtod(word.c_str(), &rest) : 0;
    out += rest != nullptr && *rest == 0 ? figure(value) : word;
    if (end < spec.size()) out += spec[end];
    i = end + 1;
  }
  return out;
}

std::string multiple(Real ratio) {
  constexpr Real kClose = 1.005;  // three digits would call two different numbers equal
  return fmt::format("{:.{}g}×", ratio, ratio > 1 && ratio < kClose ? 5 : 3);
}

int shade_of(Real value, Real least) {
  const auto is_passed = [ratio = value / least](Real step) { return ratio > step; };
  return static_cast<int>(std::ranges::count_if(kShades, is_passed));
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += between;
    text += words[i];
  }
  return text;
}

std::string first_of(std::vector<std::string> names, std::size_t most, std::string_view between) {
  const std::size_t more = names.size() > most ? names.size() - most : 0;
  names.resize(names.size() - more);
  return joined(names, between) + (more > 0 ? fmt::format(" and {} more", more) : "");
}

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string interval_name(std::size_t count) {
  return count < kFewestForInterval ? fmt::format("range of {}", count) : "95 % bootstrap interval";
}

std::string ordinal(std::size_t place) {
  constexpr std::array<const char*, 4> kEnds = {"th", "st", "nd", "rd"};
  const std::size_t last = place % 10, tens = place / 10 % 10;
  return fmt::format("{}{}", place, tens == 1 || last >= kEnds.size() ? "th" : kEnds[last]);
}

std::string problem_name(const ProblemAxis& problem) {
  return shown_spec(problem.label.empty() ? problem.spec : problem.label) +
         marks_text({.is_foreign = problem.is_foreign});
}

std::string optimizer_name(const OptimizerAxis& optimizer) {
  return shown_spec(optimizer.brief) + marks_text({.is_foreign = optimizer.is_foreign});
}

std::string marks_of(const OptimizerAxis& optimizer) {
  Marks marks = optimizer.marks();
  marks.is_foreign = false;  // its name says so
  return marks_text(marks);
}

std::string optimizer_text(const Comparison& c, std::size_t s) {
  return optimizer_name(c.optimizers[s]) + marks_of(c.optimizers[s]);
}

std::string name_in_sentence(const OptimizerAxis& optimizer) {
  std::string name = shown_spec(optimizer.brief);
  const std::size_t close = name.rfind(']'), from = close == std::string::npos ? 0 : close;
  const std::size_t comma = name.find(", ", from);
  return comma == std::string::npos ? name : name.replace(comma, 2, " (") + ")";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
  return text;
}

Marks marks_shown(const Comparison& c) {
  Marks shown;
  for (const ProblemAxis& problem : c.problems) shown.is_foreign |= problem.is_foreign;
  for (const OptimizerAxis& axis : c.optimizers) {
    const Marks marks = axis.marks();
    shown.has_extra_information |= marks.has_extra_information;
    shown.is_foreign |= marks.is_foreign;
    shown.is_imported |= marks.is_imported;
  }
  return shown;
}

std::string marks_legend(const Comparison& c) {
  const Marks shown = marks_shown(c);
  std::vector<std::string> all;
  if (shown.has_extra_information) all.push_back(words("marks.extra"));
  if (shown.is_foreign) all.push_back(words("marks.foreign"));
  if (shown.is_imported) all.push_back(words("marks.imported"));
  return joined(all, " ");
}

std::string status_meaning(Status status) {
  return words(fmt::format("status.{}", name_of(status)));
}

std::string status_text(const std::map<Status, std::size_t>& statuses) {
  std::string text;
  for (const auto& [status, count] : statuses)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name_of(status), count);
  return text;
}

std::string count_text(const Cell& cell, std::size_t tolerance) {
  const Spread& work = cell.headline[tolerance];
  std::string text = fmt::format("{}/{}", work.n - work.unsolved, work.n);
  if (cell.failed > 0) text += fmt::format(", {} failed", cell.failed);
  if (cell.missing() > 0) text += fmt::format(", {} missing", cell.missing());
  return text;
}

std::string matrix_text(const Comparison& c, const Cell& cell, std::size_t tolerance) {
  if (cell.planned == 0) return "";
  if (cell.runs.empty()) return "missing";
  if (!cell.is_measured()) return "n/a";
  if (c.problems[c.runs[cell.runs[0]].problem].lacks_least_loss()) return "?";
  const Real median = cell.headline[tolerance].median;
  const bool is_shared = c.yardstick.by == Measure::time && !cell.is_timed_alone;
  return amount(c, median) + (is_shared && median < kNever ? "≈" : "");
}

bool is_complete(const Cell& cell, std::size_t tolerance) {
  return cell.headline[tolerance].unsolved == 0 && cell.failed == 0 && cell.missing() == 0;
}

std::string rerun_arguments(const Request& request) {
  std::set<std::string> libraries;
  for (const Component* part : {&request.problem, &request.optimizer})
    if (part->foreign && part->foreign->door == "plugin") libraries.insert(part->foreign->command);
  std::string plugins;
  for (const std::string& library : libraries) plugins += " --plugin " + shell_word(library);
  return fmt::format("--problem {} --optimizer {} --seeds ={} {} --rates none{}",
                     shell_word(request.problem.spec), shell_word(request.optimizer.spec),
                     seed_text(request.seed), budget_options(request), plugins);
}

std::string rerun_command(const Request& request) {
  return "./isoline run " + rerun_arguments(request);
}

// The yardstick.

std::string tau_name(const Comparison& c) { return std::string(c.yardstick.tightest().name); }

std::string_view counted_name(Measure by) {
  constexpr std::array<std::string_view, kMeasures.size()> kNames = {"work", "measured cost",
                                                                     "iterations", "wall time"};
  return kNames[static_cast<std::size_t>(by)];
}
std::string_view counted_name(const Comparison& c) { return counted_name(c.yardstick.by); }

std::string_view unit_name(Measure by) {
  constexpr std::array<std::string_view, kMeasures.size()> kNames = {
      "forward solves", "equivalent forward solves", "iterations", "ms"};
  return kNames[static_cast<std::size_t>(by)];
}
std::string_view unit_name(const Comparison& c) { return unit_name(c.yardstick.by); }

std::string counted_to_tau(const Comparison& c) {
  const std::string text = fmt::format("{} needed to reach {}", counted_name(c), tau_name(c));
  return counted_name(c) == unit_name(c) ? text : fmt::format("{}, in {}", text, unit_name(c));
}

std::string amount(Measure by, Real value) {
  return by == Measure::time ? milliseconds(value) : reached_figure(value);
}
std::string amount(const Comparison& c, Real value) { return amount(c.yardstick.by, value); }
std::string amount_in_units(const Comparison& c, Real value) {
  const std::string text = fmt::format("{} {}", amount(c, value), unit_name(c));
  return text.starts_with("1 ") && !text.ends_with("ms") ? text.substr(0, text.size() - 1) : text;
}

std::string_view setting_noun(const Comparison& c) {
  return c.problems.size() > c.names ? "setting" : "problem";
}

std::string_view common_noun(const Comparison& c) {
  return names_of(c, c.order) == c.order.settings.size() ? "problem" : "setting";
}

std::string n_column(const Comparison& c) { return fmt::format("n {}s", setting_noun(c)); }

std::string counted_settings(const Comparison& c, std::size_t count) {
  return counted(count, setting_noun(c));
}

std::string success_text(const Comparison& c) {
  const auto in_x = static_cast<std::size_t>(std::ranges::count_if(
      c.problems, [](const ProblemAxis& problem) { return problem.aim == Aim::x; }));
  const char* key = in_x == 0                   ? "success.loss"
                    : in_x == c.problems.size() ? "success.x"
                                                : "success.both";
  std::size_t by_fit = 0;
  for (std::size_t p = 0; p < c.problems.size(); ++p) by_fit += is_judged_by_fit(c, p);
  return words(key, tau_name(c), counted_settings(c, in_x)) +
         (by_fit > 0 ? " " + words("success.fit", counted_settings(c, by_fit)) : "");
}

bool is_judged_by_fit(const Comparison& c, std::size_t problem) {
  const OptionValues* const options = options_of(c, problem);
  return options != nullptr && options->contains("goal") && options->text("goal") == "fit";
}

// Origins of rates, by the records that used them.

namespace {

const Request* request_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  return cell.runs.empty() ? nullptr : &c.runs[cell.runs.front()].record->request;
}

// "3.8e-5" of gd[rate=3.8e-5], "rate=1, momentum=0.9" where there are several, "default" of gd.
std::string values_text(const Request& request) {
  const Spec spec = parse_spec(request.optimizer.spec);
  std::vector<std::string> shown;  // long numbers cut
  for (const auto& [name, value] : spec.options)
    shown.push_back(shown_spec(fmt::format("{}={}", name, value)));
  if (shown.empty()) return "default";
  return shown.size() > 1 ? joined(shown) : shown[0].substr(spec.options[0].first.size() + 1);
}

}  // namespace

const TunedRate* rate_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Request* request = request_of(c, p, s);
  if (request == nullptr || request->rates.empty()) return nullptr;
  for (const TunedRate& rate : c.study->rates)
    if (rate.problem == request->problem.spec && rate.optimizer == request->optimizer.name &&
        rate.file == request->rates)
      return &rate;
  return nullptr;
}

Origin origin_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Request* request = request_of(c, p, s);
  if (request == nullptr) return Origin::defaults;
  if (request->rates.empty())
    return request->optimizer.spec == request->optimizer.name ? Origin::defaults : Origin::given;
  const TunedRate* rate = rate_of(c, p, s);
  if (rate == nullptr) return Origin::table;
  return rate->is_tuned() ? Origin::tuned : Origin::published;
}

std::string origin_text(const Comparison& c, std::size_t p, std::size_t s) {
  constexpr std::array<std::string_view, 5> kNames = {"at its defaults", "as given", "tuned",
                                                      "published", "from a table"};
  const Origin origin = origin_of(c, p, s);
  if (origin == Origin::defaults || origin == Origin::given) return "";
  const TunedRate* rate = rate_of(c, p, s);
  return fmt::format(
      "{}, {}{}", values_text(*request_of(c, p, s)), kNames[static_cast<std::size_t>(origin)],
      rate == nullptr || rate->setting.empty() ? "" : " on " + shown_spec(rate->setting));
}

std::string setting_text(const Comparison& c, std::size_t p, std::size_t s) {
  const std::string origin = origin_text(c, p, s);
  if (origin.empty()) return shown_spec(c.optimizers[s].label);
  return fmt::format("{} ({})", c.optimizers[s].method, origin);
}

}  // namespace isoline::reports
