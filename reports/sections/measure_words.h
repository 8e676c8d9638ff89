// What a report counts and to which tolerance, in words: one wording of its yardstick.
#pragma once

#include <string>
#include <string_view>

#include "reports/read/comparison.h"

namespace isoline::reports {

std::string tau_name(const Comparison& comparison);  // "1e-6", the headline's

// "declared work", "cost at measured prices", "iterations", "wall time".
std::string_view counted_name(Measure by);
std::string_view counted_name(const Comparison& comparison);
std::string_view unit_name(Measure by);  // "forward solves", …, "ms"
std::string_view unit_name(const Comparison& comparison);

// "declared work to 1e-6, in forward solves", "iterations to 1e-6".
std::string counted_to_tau(const Comparison& comparison);

// An amount as tables write it, ✗ where infinite: times are given in seconds and told in ms.
std::string amount(Measure by, Real value);
std::string amount(const Comparison& comparison, Real value);
// "≈" where it is a time that was taken while other runs shared the machine.
std::string_view time_mark(const Comparison& comparison, const Cell& cell);

// A row of a study is a setting where some problem has several: "problem" or "setting".
std::string_view setting_noun(const Comparison& comparison);
std::string_view common_noun(const Comparison& comparison);  // of the settings of the common order
std::string n_column(const Comparison& comparison);  // "n settings", the heading of their number
std::string counted_settings(const Comparison& comparison, std::size_t count);  // "22 settings"

// What success means at this yardstick, a sentence; in a study of one aim, of that alone.
std::string success_text(const Comparison& comparison);

}  // namespace isoline::reports
