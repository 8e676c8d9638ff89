// The initial temperature of a rod with both ends at 0, from the temperature at the time T: u_t =
// u_xx on (0, 1), N inner points, spacing h = 1/(N + 1), by n steps of Euler's explicit method with
// r = Δt/h² just above 5/11,
//
//   y = (1 − r D)ⁿ x,  D = tridiag(−1, 2, −1).
//
// Its eigenvectors are the sines, sin(πki/(N + 1)), with the factors (1 − 4r sin²(πk/2(N + 1)))ⁿ,
// and so it is computed. Riis et al. (2024), CUQIpy's Heat1D with its defaults: N = 128, T = 0.2,
// x* = s e^(−2s) sin(1 − s) at the point s. The noise there, ‖y*‖/200 per value, is the option
// noise of every problem here. Other instances have s e^(−as) sin(1 − s).
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/fourier.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

struct Heat1d {
  Index N = 128;
  Real time = 0.2;
};
void fields(Heat1d& o, auto& field) {
  field("N", o.N, between(2, 2048), "inner points");
  field("time", o.time, between(1e-3, 1), "time T of the data");
}

class Rod final : public SelfAdjointPhysics {
 public:
  Rod(Index N, Real time) : sine_(N), gain_(N) {
    constexpr Real kRatio = 5.0 / 11;  // of a time step to h², below ½ for stability
    const Real h = 1 / static_cast<Real>(N + 1), steps = std::floor(time / (kRatio * h * h));
    const Real r = time / steps / (h * h);
    for (Index k = 0; k < N; ++k) {
      const Real sine = std::sin(std::numbers::pi * static_cast<Real>(k + 1) * h / 2);
      gain_[k] = std::pow(1 - 4 * r * sine * sine, steps);
    }
  }
  Index inputs() const override { return gain_.size(); }
  Index outputs() const override { return gain_.size(); }
  void apply(BatchRef x, BatchOut y) const override {
    sine_.columns(x, y);
    y.array().colwise() *= gain_.array() / sine_.round_trip();
    sine_.columns(y, y);
  }

  // The least error of a solution that is cut off after the first modes, with rounding as noise.
  Real floor_of(const Vector& truth) const {
    constexpr Real kRounding = std::numeric_limits<Real>::epsilon();
    Matrix modes(truth.size(), 1);  // of x*, by orthonormal sines
    sine_.columns(truth, modes);
    modes /= std::sqrt(sine_.round_trip());
    const Real noise = kRounding * modes.col(0).cwiseProduct(gain_).norm();
    Real squared = modes.squaredNorm(), least = squared;
    for (Index k = 0; k < gain_.size() && gain_[k] != 0; ++k) {
      squared += std::pow(noise / gain_[k], 2) - std::pow(modes(k, 0), 2);
      least = std::min(least, squared);
    }
    return std::sqrt(std::max<Real>(least, 0));
  }

 private:
  mutable SineTransform sine_;  // it has scratch
  Vector gain_;                 // (N), by mode
};

Vector truth_of(Index N, const Draw& draw) {
  const Real a = draw.is_published() ? 2 : draw.stream("target").uniform(0, 8);
  Vector truth(N);
  for (Index i = 0; i < N; ++i) {
    const Real s = static_cast<Real>(i + 1) / static_cast<Real>(N + 1);
    truth[i] = s * std::exp(-a * s) * std::sin(1 - s);
  }
  return truth;
}

ProblemParts make_heat_1d(const Heat1d& o, const Draw& draw) {
  auto physics = std::make_unique<Rod>(o.N, o.time);
  const Vector truth = truth_of(o.N, draw);
  const Real floor = physics->floor_of(truth);
  ProblemParts parts = from_exact_data(std::move(physics), truth, draw, StartScale::own);
  parts.x_floor = [floor](const Batch&) { return floor; };
  return parts;
}

}  // namespace

void register_heat_1d(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "heat-1d",
       .title = "Heat equation in one dimension",
       .group = Group::physics,
       .formula = "P(x) = u(T),  u_t = u_xx,  u(0) = x,  u = 0 at both ends,  L = ½‖P(x) − y*‖²",
       .source = "Riis, Alghamdi, Uribe, Christensen, Afkham, Hansen, Jørgensen (2024), CUQIpy",
       .note = "CUQIpy’s data have noise of ‖y*‖/200 per value, which is noise=0.0566 here. Every "
               "start is 0. At T = 0.2, the data determine the first three or four modes of x.",
       .aim = Aim::x,
       .family = "gaussian-blur",
       .is_linear = true,
       .in_all = false},
      make_heat_1d));
}

}  // namespace isoline::problems
