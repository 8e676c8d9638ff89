// Arrays of numbers in a file the user brings or takes away: `.npy`, or `.csv` with a row a line.
#pragma once

#include "core/records/npy.h"

namespace isoline {

// UsageError, naming file and line, where it cannot be read or holds what is no finite number. A
// first line of a CSV file that holds no number at all is taken for its header.
NumberArray read_numbers(const std::filesystem::path& path);

// Whole or not at all. A CSV file has one line for each of the first index.
void write_numbers(const std::filesystem::path& path, const NumberArray& array);

}  // namespace isoline
