// The results of a learning run on some validation samples, one per column. Older records have one
// sample as N×N grids instead, in an array (3, N, N) of y*, x and x* in `.npy` beside them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/real.h"

namespace isoline {

struct Exhibit {
  Index grid = 0;         // N of older records, or 0
  Grid target, x, truth;  // one sample per column

  bool is_picture() const { return grid > 0; }
};

// x of a run at some of its kept iterations, where x and y are numbers on one grid of cells. The
// numbers stand beside the record, in CELL-BUILD.npy: float32 of the shape (planes, rows, columns),
// which are y*, x* where it is known, and x by iteration.

struct FieldFrames {
  std::vector<std::int64_t> iterations = {};
  std::vector<Index> shape = {};
  std::string digest;               // of the file
  std::vector<float> numbers = {};  // as the file has them; empty where they are still there

  bool has_truth() const { return shape[0] == static_cast<Index>(iterations.size()) + 2; }
  std::span<const float> target() const { return plane(0); }  // row by row
  std::span<const float> truth() const { return plane(1); }
  std::span<const float> x(std::size_t i) const { return plane(i + (has_truth() ? 2 : 1)); }
  bool operator==(const FieldFrames& other) const {  // the digest stands for the numbers
    return iterations == other.iterations && shape == other.shape && digest == other.digest;
  }

 private:
  std::span<const float> plane(std::size_t i) const {
    const auto cells = static_cast<std::size_t>(shape[1] * shape[2]);
    return std::span(numbers).subspan(i * cells, cells);
  }
};

// UsageError where iterations and shape cannot belong together.
void require_sound(const FieldFrames& frames);

// The file's bytes.
std::string field_file(const FieldFrames& frames);

inline std::filesystem::path field_path(std::filesystem::path record) {
  return record.replace_extension(".npy");
}

// The numbers out of the file; UsageError, naming it, where it is missing, is damaged or is another
// run's.
void read_field_numbers(FieldFrames& frames, const std::filesystem::path& path);

// The file beside an older record, as what it would be today: x at the last iteration alone.
FieldFrames frames_of(const Exhibit& pictures, std::int64_t last_iteration,
                      const std::filesystem::path& path);

}  // namespace isoline
