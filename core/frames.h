// Images of the first sample of a batch, with one number per cell of a field, and the images that a
// run stores.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/array.h"
#include "core/field.h"

namespace isoline {

// The curl of a velocity on a periodic grid, ∂v/∂i − ∂u/∂j by central differences, in units of a
// cell: u and v are the first and second half of `velocity`, column by column. (rows · columns)
Vector curl(VectorRef velocity, Index rows, Index columns);

// The states from x on, at even times, each a row of `states` (rows, columns).
using History = std::function<void(VectorRef x, BatchOut states)>;

// The sample itself, or its curl if it has two numbers per cell. For a field that is a history, all
// states after x; for y, whose history is unknown, the last row only, with 0 elsewhere.
// The batch outlives the snapshot.
class Picture {
 public:
  Picture(const Matrix& batch, const std::optional<Field>& field, const History& history = {});
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;
  std::span<const Real> cells() const { return cells_; }  // empty where there is no sample

 private:
  Vector drawn_;  // where it is more than the sample
  std::span<const Real> cells_;
};

// Which x of a run are kept, where x is a field: some that are spread as the logarithm of their
// iteration, whenever the run ends.

inline constexpr std::size_t kMostFrames = 6;  // that a record keeps

// y*, x* and x of the first sample that judges, in the single precision that files keep.
struct Frames {
  static constexpr std::size_t kPlaces = 12;
  static constexpr int kCells = 128 * 128;  // of the largest grid
  int rows = 0, columns = 0;                // 0: nothing is kept
  bool has_truth = false, has_context = false, has_y = false;
  std::int64_t iteration[kPlaces];  // −1: nothing there
  float target[kCells], truth[kCells], x[kPlaces][kCells];
  float y[kCells], context[kCells];  // y of the last x

  Frames() { std::fill_n(iteration, kPlaces, -1); }
};
bool are_sound(const Frames& frames);  // of a valid size, and at valid iterations

// Reserves storage for x (rows · columns), and stores y* and, if known, x* and the context of the
// same size. Stores nothing if the grid has too many cells.
void open_frames(Frames& frames, Index rows, Index columns, std::span<const Real> target,
                 std::span<const Real> truth, std::span<const Real> context = {});

// Stores x of an iteration after the previous one, or replaces the last one. Skips an x that is not
// finite in single precision. If all places are taken, drops the x whose neighbours, in the
// logarithm of iterations, are nearest.
void keep_frame(Frames& frames, std::int64_t iteration, std::span<const Real> x,
                std::span<const Real> y = {});

// The places of at most six frames by iteration: the first, the last, and between them those
// nearest to an even spread of log(1 + iteration).
std::vector<std::size_t> chosen_frames(const Frames& frames);

}  // namespace isoline
