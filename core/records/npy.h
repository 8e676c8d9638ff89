// Arrays in NumPy's file format, version 1.0 (NumPy's numpy.lib.format): read and written whole.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/real.h"

namespace isoline {

// Numbers in the order of the file's bytes, which is that of C: the last index runs fastest.
struct NumberArray {
  std::vector<Index> shape;
  std::vector<Real> values;
};

// Of the bytes of such a file; UsageError, which does not name it, where they are none. A header
// longer than NumPy itself reads is refused, and a shape is held to the bytes that are there before
// room is made for it.
NumberArray npy_from_bytes(const std::string& bytes);

// Float and integer arrays of 4 or 8 bytes a number, in either order of indices; UsageError, naming
// the file, where it is none, is cut short, or holds a number that is not finite.
NumberArray read_npy(const std::filesystem::path& path);

// The bytes of a file of float32. There are as many values as the shape asks for.
std::string npy_bytes(const std::vector<Index>& shape, const std::vector<float>& values);

// As float64; whole or not at all.
void write_npy(const std::filesystem::path& path, const NumberArray& array);

// Arrays of numbers in a file the user brings or takes away: `.npy`, or `.csv` with a row a line.

// UsageError, naming file and line, where it cannot be read or holds what is no finite number. A
// first line of a CSV file that holds no number at all is taken for its header.
NumberArray read_numbers(const std::filesystem::path& path);

// Whole or not at all. A CSV file has one line for each of the first index.
void write_numbers(const std::filesystem::path& path, const NumberArray& array);

}  // namespace isoline
