// How figures, counts and commands are written, the same way in every format.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/results/ranking.h"

namespace isoline::reports {

using namespace results;

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
// The shade of a heat map: 0 the least, then one step for each factor of two of value / least, up
// to
// 7. Both are above 0.
inline constexpr std::array<Real, 7> kShades = {1, 2, 4, 8, 16, 32, 64};
int shade_of(Real value, Real least);

std::string joined(const std::vector<std::string>& words, std::string_view between = ", ");
std::string counted(std::size_t count, std::string_view noun);  // "1 seed", "3 seeds"
// The name of a bootstrap range over so few: "range of 3", or "95 % bootstrap interval".
std::string interval_name(std::size_t count);
std::string ordinal(std::size_t place);  // "1st", "13th"

// A spec as people read it: "newton[rate=0.3333]", its long numbers cut to four digits.
std::string shown_spec(std::string_view spec);
// The name of an external component, with its mark: "spring ‡".
std::string problem_name(const ProblemAxis& problem);
std::string optimizer_name(const OptimizerAxis& optimizer);
std::string optimizer_text(const Comparison& comparison, std::size_t optimizer);  // "sip †"
Marks marks_shown(const Comparison& comparison);         // by any problem or method
std::string marks_legend(const Comparison& comparison);  // what †, ‡ and § mean, of those shown
// " †" of a method that sees what others do not, " §" of one whose figures are claims of others.
std::string marks_of(const OptimizerAxis& optimizer);
std::string status_meaning(Status status);  // "used up their work or iterations"
std::string status_text(const std::map<Status, std::size_t>& statuses);  // "target 3, budget 2"

// "4/5, 1 failed": runs that reached the tolerance of all runs; is_complete says that nothing is
// lacking, so that small tables may leave it out.
std::string count_text(const Cell& cell, std::size_t tolerance);
bool is_complete(const Cell& cell, std::size_t tolerance);

// The median of what the yardstick counts, ✗, "n/a", "missing", or nothing where nothing was
// planned.
std::string matrix_text(const Comparison& comparison, const Cell& cell, std::size_t tolerance);

// The command that asks for the same cell again: all its options explicit, no table of rates.
std::string rerun_command(const Request& request);
std::string rerun_arguments(const Request& request);  // what follows `run`
std::string budget_options(const Request& request);   // "--iterations 1000 --rates none"

}  // namespace isoline::reports
