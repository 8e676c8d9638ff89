// How figures and foreign text are written, the same way in every format.
#pragma once

#include <string>
#include <string_view>

#include "reports/statistics/statistics.h"

namespace isoline::reports {

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

// A spec as people read it: "newton[rate=0.3333]", its long numbers cut to four digits.
std::string shown_spec(std::string_view spec);

// Text from records, made safe for the place it goes to.
std::string html_text(std::string_view text);
std::string markdown_text(std::string_view text);
std::string latex_text(std::string_view text);
std::string csv_field(std::string_view text);
std::string terminal_text(std::string_view text);  // no escape sequence passes
std::string shell_word(std::string_view text);

}  // namespace isoline::reports
