// Gauss-Newton over a few coarse modes.
#include "problems/physics/flow_inverses.h"

#include <cmath>
#include <numbers>

#include "core/decompose.h"
#include "problems/physics/flow_physics.h"

namespace isoline::problems {

// The curl of ψ = cos n·φ is (−n_y sin n·φ, n_x sin n·φ) up to a sign; the curl of sin is
// analogous.
CoarseInverse::CoarseInverse(Index N) : cells_(N * N), modes_(Matrix::Zero(2 * N * N, kModes)) {
  modes_.col(0).head(cells_).setOnes();
  modes_.col(1).tail(cells_).setOnes();
  constexpr Index kNumbers[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
  for (Index mode = 0; mode < 4; ++mode)
    for (Index p = 0; p < cells_; ++p) {
      const Real nx = static_cast<Real>(kNumbers[mode][0]);
      const Real ny = static_cast<Real>(kNumbers[mode][1]);
      const Index column = p % N, row = p / N;
      const Real x = static_cast<Real>(column) + 0.5, y = static_cast<Real>(row) + 0.5;
      const Real angle = 2 * std::numbers::pi * (nx * x + ny * y) / static_cast<Real>(N);
      for (const Index phase : {0, 1}) {
        const Real wave = phase == 0 ? std::sin(angle) : std::cos(angle);
        modes_(p, 2 + 2 * mode + phase) = -ny * wave;
        modes_(cells_ + p, 2 + 2 * mode + phase) = nx * wave;
      }
    }
  moved_.resize(cells_, kModes);
  tangent_.resize(3 * cells_);
}

Real CoarseInverse::misfit(Simulation& flow, LowPass& low_pass, VectorRef x, VectorRef first,
                           VectorRef y) {
  flow.begin(x, first, run_);
  flow.forward(run_);
  residual_ = run_.states.rightCols<1>().tail(cells_);
  low_pass.apply(residual_, residual_);
  residual_ = y - residual_;
  return residual_.squaredNorm();
}

bool CoarseInverse::step(Simulation& flow, LowPass& low_pass, VectorRef first, VectorRef y,
                         VectorOut x) {
  const Real before = misfit(flow, low_pass, x, first, y);
  if (!std::isfinite(before)) return false;
  for (Index i = 0; i < kModes; ++i) {
    flow.begin_pushforward(modes_.col(i), tangent_.head(2 * cells_));
    tangent_.tail(cells_).setZero();
    flow.pushforward(run_, tangent_);
    low_pass.apply(tangent_.tail(cells_), moved_.col(i));
  }
  Vector along;
  constexpr Real kCutoff = 1e-3;  // of the largest pivot: what moves y less is left alone
  if (!least_squares(moved_, residual_, kCutoff, along)) return false;
  constexpr int kHalvings = 6;
  for (int halving = 0; halving < kHalvings; ++halving, along /= 2) {
    trial_ = x + modes_ * along;
    if (!(misfit(flow, low_pass, trial_, first, y) < before)) continue;
    x = trial_;
    return true;
  }
  return false;
}

bool CoarseInverse::invert(Simulation& flow, LowPass& low_pass, VectorRef x0, VectorRef first,
                           VectorRef y, VectorOut x) {
  x = x0;
  Index taken = 0;
  while (taken < kSteps && step(flow, low_pass, first, y, x)) ++taken;
  return taken > 0;
}

// Translation and vortex, estimated.

namespace {

using Point2 = Eigen::Vector2d;

Real cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

const Point2 kMiddle(kFlowMiddle, kFlowMiddle);

}  // namespace

Real VortexInverse::missing_strength(const Point2& c0, const Point2& cT) const {
  constexpr Real kGain = 1e-3;
  const auto centre = [this](const FlowRun& run, Index n) {
    return centre_of_mass(N_, run.marker(n));
  };
  const Real last = static_cast<Real>(steps_), unit = track_ == Track::published ? time_ : last;
  const Point2 end = kMiddle + (kMiddle - c0);
  Real sum = cross(centre(forward_, steps_) - cT, cT - end);
  for (Index i = 0; i < steps_; ++i) {
    const Index n = steps_ - 1 - i;
    const Point2 on_track = kMiddle + (kMiddle - c0) * (static_cast<Real>(n) / unit);
    const Point2 returned = centre(back_, i + 1);
    sum += cross(centre(forward_, n) - returned, returned - on_track);
  }
  return kGain * sum / (last + 1);
}

bool VortexInverse::invert(Simulation& flow, VectorRef x0, VectorRef first, VectorRef last,
                           VectorOut x) {
  flow.begin(x0, first, forward_);
  flow.forward(forward_);
  flow.reverse(forward_, last, back_);
  const Point2 c0 = centre_of_mass(N_, first), cT = centre_of_mass(N_, last);
  const Real strength = vortex_strength(N_, x0) + missing_strength(c0, cT);
  if (!std::isfinite(strength) || !is_finite(c0)) {
    x = x0;
    return false;
  }
  for (const Index axis : {0, 1})
    x.segment(axis * N_ * N_, N_ * N_).setConstant((kFlowMiddle - c0[axis]) / time_);
  add_vortex(N_, strength, x);
  return true;
}

}  // namespace isoline::problems
