// Flows and markers, drawn.
#include "problems/physics/flow_samples.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "problems/random_fields.h"

namespace isoline::problems {
namespace {

constexpr Real kNoiseScale = 10;  // of random_fields.h, in units of length

Real place(Index i, Index N) {
  return (static_cast<Real>(i) + 0.5) * kFlowLength / static_cast<Real>(N);
}

// visit(p, x, y) for the centre of every cell.
template <class Visit>
void each_cell(Index N, const Visit& visit) {
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i < N; ++i) visit(i + N * j, place(i, N), place(j, N));
}

Vector noise(Index N, RandomStream& stream) {
  return smooth_noise(N, kNoiseScale * static_cast<Real>(N) / kFlowLength, 1, stream);
}

// The cells of a box where noise is highest; as many as there are, unless the box has fewer above
// 0, the value outside.
Vector marker(Index N, const Eigen::Vector2d& centre, Real share, RandomStream& stream) {
  constexpr Real kHalfBox = 28;
  Vector height = noise(N, stream), inside(N * N);
  each_cell(N, [&](Index p, Real x, Real y) {
    const Real off = std::max(std::abs(x - centre.x()), std::abs(y - centre.y()));
    inside[p] = off <= kHalfBox ? 1 : 0;
  });
  height.array() *= inside.array();
  const auto count = static_cast<Index>(std::llround(share * static_cast<Real>(N * N)));
  Vector sorted = height;
  const auto last = sorted.begin() + std::max<Index>(count, 1) - 1;
  std::nth_element(sorted.begin(), last, sorted.end(), std::greater<>());
  const Real least = *last;
  return (height.array() >= least).select(inside, 0);
}

}  // namespace

FlowSample draw_flow(Index N, Real time, RandomStream& stream) {
  const Real x = stream.uniform(32, 96), y = stream.uniform(32, 96);
  const Real share = stream.uniform(0.05, 0.15), strength = stream.uniform(-2, 2);
  constexpr Real kFluctuation = 0.1;
  FlowSample sample;
  sample.strength = strength;
  sample.marker = marker(N, {x, y}, share, stream);
  sample.velocity.resize(2 * N * N);
  const Eigen::Vector2d centre = centre_of_mass(N, sample.marker);
  for (const Index axis : {0, 1})
    sample.velocity.segment(axis * N * N, N * N) =
        kFluctuation * noise(N, stream).array() + (kFlowMiddle - centre[axis]) / time;
  add_vortex(N, strength, sample.velocity);
  return sample;
}

void add_vortex(Index N, Real strength, VectorOut velocity) {
  constexpr Real kWidth = 800;  // 2σ², σ = 20
  each_cell(N, [&](Index p, Real x, Real y) {
    const Real rx = x - kFlowMiddle, ry = y - kFlowMiddle;
    const Real swirl = strength * std::exp(-(rx * rx + ry * ry) / kWidth);
    velocity[p] -= swirl * ry;
    velocity[N * N + p] += swirl * rx;
  });
}

Real vortex_strength(Index N, VectorRef velocity) {
  constexpr Real kPublishedUnit = 120.5;
  Real sum = 0;
  each_cell(N, [&](Index p, Real x, Real y) {
    sum += (x - kFlowMiddle) * velocity[N * N + p] - (y - kFlowMiddle) * velocity[p];
  });
  return sum / static_cast<Real>(N * N) / kPublishedUnit;
}

Eigen::Vector2d centre_of_mass(Index N, VectorRef marker) {
  Eigen::Vector2d sum(0, 0);
  each_cell(N, [&](Index p, Real x, Real y) { sum += marker[p] * Eigen::Vector2d(x, y); });
  return sum / marker.sum();
}

}  // namespace isoline::problems
