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

// From the bytes of such a file; UsageError, without its name, if they are invalid. A header longer
// than NumPy's limit is refused, and the shape is checked against the available bytes before any
// allocation.
NumberArray npy_from_bytes(const std::string& bytes);

// Float and integer arrays of 4 or 8 bytes per number, in either order of indices; UsageError, with
// the name of the file, if it is invalid or truncated, or holds a number that is not finite.
NumberArray read_npy(const std::filesystem::path& path);

// The file beside a record that has this digest and this shape; UsageError, naming it, where it is
// missing, is damaged or is another run's.
NumberArray read_npy_beside(const std::filesystem::path& path, const std::string& digest_of_file,
                            const std::vector<Index>& shape);

// The bytes of a float32 file. The number of values must fit the shape.
std::string npy_bytes(const std::vector<Index>& shape, const std::vector<float>& values);

// As float64: the bytes of a file, or a file, whole or not at all.
std::string npy_bytes(const NumberArray& array);
void write_npy(const std::filesystem::path& path, const NumberArray& array);

// Arrays of numbers in a user's file: `.npy`; or `.csv`, `.txt` or `.dat` with one row per line.

// UsageError, with file and line, if it cannot be read or holds a number that is not finite.
// Numbers and their separators are those of core/numbers.h. If the first line of a CSV file holds
// no number, it is the header; lines that begin with # are comments.
NumberArray read_numbers(const std::filesystem::path& path);

// Whole or not at all. A CSV file has one line for each of the first index.
void write_numbers(const std::filesystem::path& path, const NumberArray& array);

}  // namespace isoline
