// Which x of a run are kept, where x is a field: some that are spread as the logarithm of their
// iteration, whenever the run ends.
#pragma once

#include <span>
#include <vector>

#include "core/real.h"
#include "core/trace.h"

namespace isoline {

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
