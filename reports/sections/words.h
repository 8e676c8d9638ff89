// How sentences, figures, names and commands are written, the same way in every format.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/results/ranking.h"
#include "core/results/study.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using namespace results;

// Sentences stand in reports/words/*.txt: "key(a, b): text with {a}", continued by indented lines.
// A line ".part: text" belongs to the key above it and has its names. Values fill the names in
// their order: {a} as figure() writes it, {a:.2f} as fmt does, {a|one|many} by whether a is 1.
struct Sentence {
  std::vector<std::string> names;
  std::string text;
};
const std::map<std::string, Sentence, std::less<>>& all_sentences();

using Value = std::variant<std::string, std::int64_t, Real>;
template <class T>
Value value_of(const T& value) {
  if constexpr (std::is_floating_point_v<T>) return Real{value};
  if constexpr (std::is_integral_v<T>) return static_cast<std::int64_t>(value);
  if constexpr (!std::is_arithmetic_v<T>) return std::string(value);
}
// An unknown key, name or number of values is a std::logic_error.
std::string filled(std::string_view key, const std::vector<Value>& values);
std::string words(std::string_view key, const auto&... values) {
  return filled(key, {value_of(values)...});
}

// The title, caption, columns (between bars), meanings and alignment of a table; the title, the
// caption and the axes of a plot; the title and the lead of a section. Its ID is its key.
Table table_filled(std::string_view key, const std::vector<Value>& values);
Plot plot_filled(std::string_view key, const std::vector<Value>& values);
Section section_filled(std::string_view key, const std::vector<Value>& values);
Table worded_table(std::string_view key, const auto&... values) {
  return table_filled(key, {value_of(values)...});
}
Plot worded_plot(std::string_view key, const auto&... values) {
  return plot_filled(key, {value_of(values)...});
}
Section worded_section(std::string_view key, const auto&... values) {
  return section_filled(key, {value_of(values)...});
}

// The one way a table writes a number, times apart: whole numbers below ten million in full, all
// others with four significant digits; "inf", "nan".
std::string figure(Real value);
std::string exact_figure(Real value);      // the shortest text that reads back as the same number
std::string milliseconds(Real seconds);    // three digits: a time deserves no more
std::string reached_figure(Real value);    // ✗ where infinite
std::string figure(const Spread& spread);  // "120 (90–300)", with ✗ for what was never reached
// "90–300", each end as `written`; empty where all agree.
std::string range_figure(const Spread& spread, std::string (*written)(Real));
std::string percent(Real share);
std::string multiple(Real ratio);  // "1.3×"
// The shade of a heat map: 0 the least, a step for each factor of two above it, to 7.
inline constexpr std::array<Real, 7> kShades = {1, 2, 4, 8, 16, 32, 64};
int shade_of(Real value, Real least);

std::string joined(const std::vector<std::string>& words, std::string_view between = ", ");
// The first `most` and how many others: "a, b and 3 more".
std::string first_of(std::vector<std::string> names, std::size_t most,
                     std::string_view between = ", ");
std::string counted(std::size_t count, std::string_view noun);  // "1 seed", "3 seeds"
// The name of a bootstrap range over so few: "range of 3", or "95 % bootstrap interval".
std::string interval_name(std::size_t count);
std::string ordinal(std::size_t place);  // "1st", "13th"

// A spec as people read it: "newton[rate=0.3333]", its long numbers cut to four digits.
std::string shown_spec(std::string_view spec);
std::string spec_without(std::string_view spec, std::string_view option);
// The name of an external component, with its mark: "spring ‡".
std::string problem_name(const ProblemAxis& problem);
std::string optimizer_name(const OptimizerAxis& optimizer);
std::string optimizer_text(const Comparison& comparison, std::size_t optimizer);  // "sip †"
// In a sentence: without marks, which tables explain, and without a comma: "sip (given P⁻¹)".
std::string name_in_sentence(const OptimizerAxis& optimizer);
std::string listed(const std::vector<std::string>& names);  // "a, b and c"
Marks marks_shown(const Comparison& comparison);            // by any problem or method
std::string marks_legend(const Comparison& comparison);  // what †, ‡ and § mean, of those shown
// " †" of a method that sees what others do not, " §" of one whose figures are claims of others.
std::string marks_of(const OptimizerAxis& optimizer);
std::string status_meaning(Status status);  // "used up their work or iterations"
std::string status_text(const std::map<Status, std::size_t>& statuses);  // "target 3, budget 2"

// "4/5, 1 failed": runs that reached the tolerance of all runs.
std::string count_text(const Cell& cell, std::size_t tolerance);
bool is_complete(const Cell& cell, std::size_t tolerance);  // all did, so that it says nothing
// The median of what the yardstick counts, ✗, "n/a", "missing", "?" where the least loss is
// unknown, or nothing where none was planned.
std::string matrix_text(const Comparison& comparison, const Cell& cell, std::size_t tolerance);

// The command that asks for the same cell again: all its options explicit, no table of rates.
std::string rerun_command(const Request& request);
std::string rerun_arguments(const Request& request);  // what follows `run`

// The yardstick.

std::string tau_name(const Comparison& comparison);  // "1e-6", the headline's
// "work", "measured cost", "iterations", "wall time"; counted in "forward solves", …, "ms".
std::string_view counted_name(Measure by);
std::string_view counted_name(const Comparison& comparison);
std::string_view unit_name(Measure by);
std::string_view unit_name(const Comparison& comparison);
// "work needed to reach 1e-6, in forward solves"
std::string counted_to_tau(const Comparison& comparison);
// An amount as tables write it, ✗ where infinite: times are given in seconds and written in ms.
std::string amount(Measure by, Real value);
std::string amount(const Comparison& comparison, Real value);
std::string amount_in_units(const Comparison& comparison, Real value);  // "1 forward solve"
// A row of a study is a setting where some problem has several: "problem" or "setting".
std::string_view setting_noun(const Comparison& comparison);
std::string_view common_noun(const Comparison& comparison);  // of the settings of the common order
std::string n_column(const Comparison& comparison);  // "n settings", the heading of their number
std::string counted_settings(const Comparison& comparison, std::size_t count);  // "22 settings"
// By the distance from the least-squares solution.
bool is_judged_by_fit(const Comparison& comparison, std::size_t problem);
// The meaning of success by this measure, as a sentence; with a single criterion, for that only.
std::string success_text(const Comparison& comparison);

// Where the options of a method came from on a problem.
enum class Origin {
  defaults,   // no rate was set
  given,      // typed, or a suite's
  tuned,      // the best of a grid, on other seeds of this very problem
  published,  // a paper's
  table,      // a table of rates; these results do not say from where it has it
};
Origin origin_of(const Comparison& comparison, std::size_t problem, std::size_t optimizer);
// The row of a table of rates that a pair ran with; none where no table had one.
const TunedRate* rate_of(const Comparison& comparison, std::size_t problem, std::size_t optimizer);
// "3.8e-5, tuned": value and origin; empty where no table chose.
std::string origin_text(const Comparison& comparison, std::size_t problem, std::size_t optimizer);
// "gd (3.8e-5, tuned)", in tables of one problem; the label alone where no table chose.
std::string setting_text(const Comparison& comparison, std::size_t problem, std::size_t optimizer);

}  // namespace isoline::reports
