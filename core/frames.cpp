// Samples as they are, curls by central differences, and histories.
#include "core/frames.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/trace.h"

namespace isoline {

Vector curl(VectorRef velocity, Index rows, Index columns) {
  const Index cells = rows * columns;
  const Eigen::Map<const Matrix> u(velocity.data(), rows, columns);
  const Eigen::Map<const Matrix> v(velocity.data() + cells, rows, columns);
  Vector out(cells);
  for (Index j = 0; j < columns; ++j) {
    const Index above = (j + 1) % columns, below = (j + columns - 1) % columns;
    for (Index i = 0; i < rows; ++i) {
      const Index right = (i + 1) % rows, left = (i + rows - 1) % rows;
      out[i + rows * j] = 0.5 * (v(right, j) - v(left, j) - u(i, above) + u(i, below));
    }
  }
  return out;
}

Picture::Picture(const Matrix& batch, const std::optional<Field>& field, const History& history) {
  if (batch.size() == 0) return;
  cells_ = {batch.data(), static_cast<std::size_t>(batch.rows())};
  if (!field) return;
  const Index rows = field->rows, columns = field->columns;
  if (field->is_history()) {
    Matrix states = Matrix::Zero(rows, columns);
    if (history)
      history(batch.col(0), states);
    else
      states.row(rows - 1) = batch.col(0).transpose();
    drawn_ = states.reshaped();
  } else if (batch.rows() == 2 * rows * columns) {
    drawn_ = curl(batch.col(0), rows, columns);
  } else {
    return;
  }
  cells_ = {drawn_.data(), static_cast<std::size_t>(drawn_.size())};
}

// Frames in their places.

namespace {

constexpr std::int64_t kFree = -1;

Real depth(std::int64_t iteration) { return std::log1p(static_cast<Real>(iteration)); }

std::vector<std::size_t> taken_places(const Frames& frames) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < Frames::kPlaces; ++i)
    if (frames.iteration[i] >= 0) places.push_back(i);
  std::ranges::sort(places, {}, [&](std::size_t i) { return frames.iteration[i]; });
  return places;
}

// Free, that of the same iteration, or that of the frame missed least once there is a later one.
std::size_t place_for(const Frames& frames, std::int64_t iteration) {
  for (const std::int64_t wanted : {iteration, kFree}) {
    const std::int64_t* const place = std::ranges::find(frames.iteration, wanted);
    if (place != std::end(frames.iteration))
      return static_cast<std::size_t>(place - std::begin(frames.iteration));
  }
  const std::vector<std::size_t> taken = taken_places(frames);
  const auto gap = [&](std::size_t i) {  // that the i-th of them would leave
    const std::int64_t after = i + 1 < taken.size() ? frames.iteration[taken[i + 1]] : iteration;
    return depth(after) - depth(frames.iteration[taken[i - 1]]);
  };
  std::size_t least = 1;
  for (std::size_t i = 2; i < taken.size(); ++i)
    if (gap(i) < gap(least)) least = i;
  return taken[least];
}

bool fits(std::span<const Real> values) {
  return std::ranges::all_of(values,
                             [](Real value) { return std::isfinite(static_cast<float>(value)); });
}

void copy(std::span<const Real> values, float* out) {
  std::ranges::transform(values, out, [](Real value) { return static_cast<float>(value); });
}

}  // namespace

bool are_sound(const Frames& frames) {
  constexpr int kMost = Frames::kCells;
  if (!is_flag(frames.has_truth) || !is_flag(frames.has_context) || !is_flag(frames.has_y) ||
      !is_within(frames.rows, kMost) || !is_within(frames.columns, kMost))
    return false;
  if ((frames.rows == 0) != (frames.columns == 0) ||
      std::int64_t{frames.rows} * frames.columns > kMost)
    return false;
  std::vector<std::int64_t> iterations;
  for (const std::int64_t iteration : frames.iteration) {
    if (iteration < -1) return false;
    if (iteration >= 0) iterations.push_back(iteration);
  }
  std::ranges::sort(iterations);
  return std::ranges::adjacent_find(iterations) == iterations.end();
}

void open_frames(Frames& frames, Index rows, Index columns, std::span<const Real> target,
                 std::span<const Real> truth, std::span<const Real> context) {
  if (rows * columns > Frames::kCells || !fits(target) || !fits(truth) || !fits(context)) return;
  copy(target, frames.target);
  copy(truth, frames.truth);
  copy(context, frames.context);
  frames.has_truth = !truth.empty();
  frames.has_context = !context.empty();
  frames.columns = static_cast<int>(columns);
  frames.rows = static_cast<int>(rows);
}

void keep_frame(Frames& frames, std::int64_t iteration, std::span<const Real> x,
                std::span<const Real> y) {
  if (frames.rows == 0 || !fits(x) || !fits(y)) return;
  const std::size_t place = place_for(frames, iteration);
  // If a process is killed within these lines, the place stays free.
  frames.iteration[place] = kFree;
  std::atomic_signal_fence(std::memory_order_seq_cst);
  copy(x, frames.x[place]);
  copy(y, frames.y);
  frames.has_y = !y.empty();
  std::atomic_signal_fence(std::memory_order_seq_cst);
  frames.iteration[place] = iteration;
}

std::vector<std::size_t> chosen_frames(const Frames& frames) {
  std::vector<std::size_t> taken = taken_places(frames);
  if (taken.size() <= kMostFrames) return taken;
  const auto depth_of = [&](std::size_t i) { return depth(frames.iteration[taken[i]]); };
  std::vector<std::size_t> chosen = {taken.front()};
  std::size_t first = 1;
  for (std::size_t i = 1; i + 1 < kMostFrames; ++i) {
    const Real even = static_cast<Real>(i) / (kMostFrames - 1) * depth_of(taken.size() - 1);
    const std::size_t end =
        taken.size() - (kMostFrames - 1 - i);  // keeps places for later iterations
    std::size_t nearest = first;
    for (std::size_t j = first + 1; j < end; ++j)
      if (std::abs(depth_of(j) - even) < std::abs(depth_of(nearest) - even)) nearest = j;
    chosen.push_back(taken[nearest]);
    first = nearest + 1;
  }
  chosen.push_back(taken.back());
  return chosen;
}

}  // namespace isoline
