// Fields in the file beside a record.
#include "core/records/parts/snapshots.h"

#include <algorithm>
#include <functional>

#include "core/errors.h"
#include "core/records/npy.h"

namespace isoline {

void require_sound(const FieldFrames& frames) {
  const auto count = static_cast<Index>(frames.iterations.size());
  const bool is_rising = std::ranges::adjacent_find(frames.iterations, std::greater_equal<>()) ==
                         frames.iterations.end();
  require(count > 0 && frames.iterations[0] >= 0 && is_rising,
          "the iterations of its fields must increase");
  constexpr Index kMostOthers = 4;  // y*, x*, y and the context
  require(
      frames.shape.size() == 3 && frames.shape[0] > count && frames.shape[0] <= count + kMostOthers,
      "the shape of its fields does not match their iterations");
  require(frames.shape[1] > 0 && frames.shape[2] > 0, "the shape of its fields has no cells");
}

std::string field_file(const FieldFrames& frames) {
  return npy_bytes(frames.shape, frames.numbers);
}

void read_field_numbers(FieldFrames& frames, const std::filesystem::path& path) {
  const NumberArray array = read_npy_beside(path, frames.digest, frames.shape);
  frames.numbers = {array.values.begin(), array.values.end()};
}

}  // namespace isoline
