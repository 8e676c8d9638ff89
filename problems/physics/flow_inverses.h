// Inverses of the flow: on a coarse grid, and of the parameters of its vortices.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/fourier.h"
#include "problems/physics/simulation.h"

namespace isoline::problems {

// Owns its work space: use one object per thread.
class LowPass {
 public:
  explicit LowPass(Index N) : fourier_(N, N), weights_(N / 2 + 1, N) {
    for (Index j = 0; j < N; ++j)
      for (Index i = 0; i <= N / 2; ++i) {
        const Real ni = static_cast<Real>(i), nj = static_cast<Real>(std::min(j, N - j));
        constexpr Real kWidth = 1.25;
        weights_(i, j) = std::exp(-0.5 * kWidth * kWidth * (ni * ni + nj * nj)) / norm(N);
      }
    weights_(0, 0) = 0;
  }

  // out = N F⁻¹ w F q, of which ‖out‖² = Σ w² |F q|². Symmetric; `out` may be q.
  void apply(VectorRef q, VectorOut out) {
    fourier_.forward(q);
    fourier_.spectrum().array() *= weights_.array();
    fourier_.inverse(out);
  }

 private:
  static Real norm(Index N) { return static_cast<Real>(N); }  // of a round trip, over N

  RealFourier2d fourier_;
  Matrix weights_;  // (N/2 + 1, N) over the norm
};

// An inverse of the flow without knowledge of how the data were made: steps of Gauss-Newton on
// ½‖y − y*‖² from x₀, over the ten coarsest divergence-free velocities, the two constants and the
// curls of cos and sin of the modes |n| = (1, 0), (0, 1), (1, 1), (1, −1). Each step takes ten
// pushforwards, and is then halved until the misfit falls.

class CoarseInverse {
 public:
  static constexpr Index kModes = 10, kSteps = 2;

  explicit CoarseInverse(Index N);

  // x0 and x (2N²) at the centres, y the marker wanted after its low pass. False where no step
  // lowers the misfit; x is x0 then.
  bool invert(Simulation& flow, LowPass& low_pass, VectorRef x0, VectorRef first, VectorRef y,
              VectorOut x);

 private:
  bool step(Simulation& flow, LowPass& low_pass, VectorRef first, VectorRef y, VectorOut x);
  Real misfit(Simulation& flow, LowPass& low_pass, VectorRef x, VectorRef first, VectorRef y);

  Index cells_;   // N²
  Matrix modes_;  // (2N², 10)
  Matrix moved_;  // (N², 10) what they do to y
  FlowRun run_;
  Vector tangent_;   // (3N²)
  Vector residual_;  // (N²)
  Vector trial_;     // (2N²)
};

// The published inverse of the fluid experiment, an estimate by how the data are made: Holl,
// Koltun, Thuerey (2022), published scripts. The translation is known from the first marker alone,
// for it brings the marker to the middle, c₀ → M within T. The vortex, around the middle and of
// known width, has the strength that x₀ has, and Δω more: the prediction is simulated forward,
// c_f(n) the centre of its marker after n of S steps, and from its end back with the marker
// observed, c_r(n);
//
//   x = (M − c₀)/T + vortex(ω(x₀) + Δω),  Δω = 10⁻³ mean of
//   (c_f(S) − c_T) × (c_T − s(S)),  (c_f(S−1−i) − c_r(i+1)) × (c_r(i+1) − s(S−1−i)),  i < S
//
// with s(n) = M + (M − c₀) n/S along the way. The scripts have s(n) = M + (M − c₀) n/T for all but
// the first, a missing Δt: Track::published. Its fluctuations are not estimated.

enum class Track { consistent, published };

class VortexInverse {
 public:
  VortexInverse(Index N, Index steps, Real time, Track track)
      : N_(N), steps_(steps), time_(time), track_(track) {}

  // x0 and x (2N²) at the centres. False, and x = x0, where a marker is empty or the flow blows up.
  bool invert(Simulation& flow, VectorRef x0, VectorRef first, VectorRef last, VectorOut x);

 private:
  Real missing_strength(const Eigen::Vector2d& c0, const Eigen::Vector2d& cT) const;  // Δω

  Index N_, steps_;
  Real time_;
  Track track_;
  FlowRun forward_, back_;
};

}  // namespace isoline::problems
