// Pictures of the first sample of a batch, one number a cell of a field, and the frames that a run
// keeps of them.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/array.h"
#include "core/field.h"
#include "core/trace.h"

namespace isoline {

// The curl of a velocity on a periodic grid, ∂v/∂i − ∂u/∂j by central differences, in units of a
// cell: u and v are the first and second half of `velocity`, column by column. (rows · columns)
Vector curl(VectorRef velocity, Index rows, Index columns);

// The states from x on, at even times, each a row of `states` (rows, columns).
using History = std::function<void(VectorRef x, BatchOut states)>;

// The sample itself, or its curl where it has two numbers a cell. Of a field that is a history all
// that follows from x; of y, of which no history is given, the last row alone, with 0 elsewhere.
// The batch outlives the picture.
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

// Makes room for x (rows · columns), and keeps y* and, where it is known, x* of the same size.
// Where there is no room for so many cells, nothing is kept.
void open_frames(Trace::Frames& frames, Index rows, Index columns, std::span<const Real> target,
                 std::span<const Real> truth);

// Keeps x of an iteration later than those before, or anew of the last one. An x that is not finite
// in single precision is no picture. Where all places are taken, the x is given up that is missed
// least: whose neighbours, in the logarithm of iterations, are nearest.
void keep_frame(Trace::Frames& frames, std::int64_t iteration, std::span<const Real> x);

// The places of at most six frames by iteration: the first, the last, and between them those
// nearest to an even spread of log(1 + iteration).
std::vector<std::size_t> chosen_frames(const Trace::Frames& frames);

}  // namespace isoline
