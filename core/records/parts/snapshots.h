// x of a run at some of its kept iterations, where x and y are numbers on one grid of cells.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

// The numbers stand beside the record, in CELL-BUILD.npy: float32 of the shape (planes, rows,
// columns), which are y*, x* where it is known, x by iteration and, beside x*, y of the last x and
// the context. Only one of two runs may keep them.
struct FieldFrames {
  static constexpr Part kPart{
      .member = "fields",
      .law = R"({"description": "x at some iterations, in the .npy file beside the record"})",
      .ignored = "*"};
  std::vector<std::int64_t> iterations = {};
  std::vector<Index> shape = {};
  std::string digest;               // of the file
  std::vector<float> numbers = {};  // as the file has them; empty where they are still there

  bool has_truth() const { return others() > 1; }
  bool has_y() const { return others() > 2; }
  bool has_context() const { return others() > 3; }
  std::span<const float> target() const { return plane(0); }  // row by row
  std::span<const float> truth() const { return plane(1); }
  std::span<const float> x(std::size_t i) const { return plane(i + (has_truth() ? 2 : 1)); }
  std::span<const float> y() const { return plane(iterations.size() + 2); }
  std::span<const float> context() const { return plane(iterations.size() + 3); }
  bool operator==(const FieldFrames& other) const {  // the digest stands for the numbers
    return iterations == other.iterations && shape == other.shape && digest == other.digest;
  }

 private:
  Index others() const { return shape[0] - static_cast<Index>(iterations.size()); }
  std::span<const float> plane(std::size_t i) const {
    const auto cells = static_cast<std::size_t>(shape[1] * shape[2]);
    return std::span(numbers).subspan(i * cells, cells);
  }
};

void fields(Like<FieldFrames> auto& frames, auto& field) {
  field("iterations", frames.iterations);
  field("shape", frames.shape);
  field("digest", frames.digest, kDigestLaw);
}

void require_sound(const FieldFrames& frames);  // UsageError where iterations and shape disagree
std::string field_file(const FieldFrames& frames);  // the file's bytes
inline std::filesystem::path field_path(std::filesystem::path record) {
  return record.replace_extension(".npy");
}
// The numbers out of the file; UsageError, naming it, where it is missing, is damaged or is another
// run's.
void read_field_numbers(FieldFrames& frames, const std::filesystem::path& path);

}  // namespace isoline
