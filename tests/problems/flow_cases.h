// What the tests of the flow share: the flow of the golden values, sampled, and noise.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "core/random.h"
#include "problems/physics/lattice.h"
#include "problems/physics/simulation.h"

namespace isoline::problems {

inline constexpr Real kLength = 128;

using Function = std::function<Real(Real x, Real y)>;

// At (Δx (i + along_x), Δx (j + along_y)), (N²).
inline Vector sampled(Index N, Real along_x, Real along_y, const Function& f) {
  const Real dx = kLength / static_cast<Real>(N);
  Vector values(N * N);
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i < N; ++i)
      values[i + N * j] =
          f(dx * (static_cast<Real>(i) + along_x), dx * (static_cast<Real>(j) + along_y));
  return values;
}

// u, v and m where this arrangement has them, (3N²).
inline Vector state_of(const FlowOptions& o, const Function& u, const Function& v,
                       const Function& m) {
  const Real face = o.arrangement == Arrangement::staggered ? 0 : 0.5;
  Vector state(3 * o.cells());
  state << sampled(o.N, face, 0.5, u), sampled(o.N, 0.5, face, v), sampled(o.N, 0.5, 0.5, m);
  return state;
}

// The flow of the golden values, which has no random numbers in it.
struct Golden {
  static constexpr Real k = 2 * std::numbers::pi / kLength;
  static Real vortex(Real x, Real y) {
    const Real rx = x - 64, ry = y - 64;
    return 1.3 * std::exp(-(rx * rx + ry * ry) / 800);
  }
  static Real u(Real x, Real y) {
    return 3 - vortex(x, y) * (y - 64) +
           0.3 * (std::sin(k * (2 * x + 3 * y)) + 0.5 * std::cos(k * (5 * x - y)));
  }
  static Real v(Real x, Real y) {
    return -2 + vortex(x, y) * (x - 64) +
           0.3 * (std::cos(k * (3 * x - 2 * y)) + 0.5 * std::sin(k * (x + 4 * y)));
  }
  static Real marker(Real x, Real y) {
    return std::exp(-(x - 50) * (x - 50) / 162 - (y - 70) * (y - 70) / 98);
  }
  // Staggered, sampled as the published scripts do: the means on the faces of what the centres
  // have.
  static Vector state(const FlowOptions& o) {
    FlowOptions centres = o;
    centres.arrangement = Arrangement::collocated;
    const Vector sampled = state_of(centres, u, v, marker);
    if (o.arrangement == Arrangement::collocated) return sampled;
    Vector state = sampled;
    const Index n = o.cells();
    weigh(o.N, 0.5, 0.5, Side::left, sampled.head(n), state.head(n));
    weigh(o.N, 0.5, 0.5, Side::below, sampled.segment(n, n), state.segment(n, n));
    return state;
  }
};

// Of every quantity, (3N²).
inline Vector noise_of(const FlowOptions& o, std::string_view purpose) {
  RandomStream stream(0, "flow", purpose);
  return stream.normal_vector(3 * o.cells());
}

}  // namespace isoline::problems
