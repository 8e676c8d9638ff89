// Foreign text, made safe for the place it goes to.
#pragma once

#include <string>
#include <string_view>

namespace isoline::reports {

std::string html_text(std::string_view text);
std::string markdown_text(std::string_view text);
std::string latex_text(std::string_view text);
std::string csv_field(std::string_view text);
std::string terminal_text(std::string_view text);  // no escape sequence passes

}  // namespace isoline::reports
