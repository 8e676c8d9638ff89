// Frames of fields as arrays of NumPy.
#include "core/records/field_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "core/digest.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/npy.h"

namespace isoline {

void require_sound(const FieldFrames& frames) {
  const auto count = static_cast<Index>(frames.iterations.size());
  const bool is_rising = std::ranges::adjacent_find(frames.iterations, std::greater_equal<>()) ==
                         frames.iterations.end();
  require(count > 0 && frames.iterations[0] >= 0 && is_rising,
          "the iterations of its fields must increase");
  require(
      frames.shape.size() == 3 && (frames.shape[0] == count + 1 || frames.shape[0] == count + 2),
      "the shape of its fields does not match their iterations");
  require(frames.shape[1] > 0 && frames.shape[2] > 0, "the shape of its fields has no cells");
}

std::string field_file(const FieldFrames& frames) {
  return npy_bytes(frames.shape, frames.numbers);
}

void read_field_numbers(FieldFrames& frames, const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  require(digest(bytes) == frames.digest,
          [&] { return fmt::format("{} is not the file that its record names", path.string()); });
  try {
    const NumberArray array = npy_from_bytes(bytes);
    require(array.shape == frames.shape, "its shape differs from the one in its record");
    frames.numbers = {array.values.begin(), array.values.end()};
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

FieldFrames frames_of(const Exhibit& pictures, std::int64_t last_iteration,
                      const std::filesystem::path& path) {
  constexpr Index kPanels = 3;  // y*, x, x*
  const Index N = pictures.grid;
  const NumberArray array = read_npy(path);
  require(array.shape == std::vector<Index>{kPanels, N, N},
          [&] { return fmt::format("{} must hold three grids of {} × {}", path.string(), N, N); });
  FieldFrames frames{.iterations = {last_iteration}, .shape = array.shape, .digest = ""};
  frames.numbers = {array.values.begin(), array.values.end()};
  const auto x = frames.numbers.begin() + N * N, truth = x + N * N;
  std::swap_ranges(x, truth, truth);
  return frames;
}

}  // namespace isoline
