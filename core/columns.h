// Text that fits the width of a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace isoline {

std::size_t terminal_width(int descriptor);  // in columns; 80 where it is not known

// The text with its longer lines broken between words. They go on below the last column of a table,
// or below their own beginning. Commands, JSON and Markdown stay whole, to be copied.
std::string fitted_text(std::string_view text, std::size_t columns);

}  // namespace isoline
