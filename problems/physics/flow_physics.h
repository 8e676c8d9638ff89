// The flows to be reconstructed, and the marker that shows them: Holl, Koltun, Thuerey (2022),
// published scripts of the fluid experiment, on a square of 128 by 128.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/array.h"
#include "core/fourier.h"
#include "core/random.h"
#include "problems/physics.h"
#include "problems/physics/flow_step.h"

namespace isoline::problems {

struct FlowSample {
  Vector velocity;  // (2N²) at the centres of the cells, x and then y
  Vector marker;    // (N²) 0 or 1
  Real strength;    // of the vortex
};

// A marker of an unusual shape within a box of 56 around a centre from U[32, 96]², a translation
// that brings it to the middle of the domain within `time`, a vortex there of strength U[−2, 2],
// and fluctuations of 0.1. The marker fills a share from U[0.05, 0.15] of all cells, sampled for
// each sample; the published scripts sample it for each batch.
FlowSample draw_flow(Index N, Real time, RandomStream& stream);

// ω ẑ × r e^(−r²/800) around the middle, added to a velocity at the centres.
void add_vortex(Index N, Real strength, VectorOut velocity);
// The strength of a velocity at the centres, as in the scripts: mean (rₓ v_y − r_y vₓ) / 120.5; for
// a vortex of strength 1 on 64×64 cells, 1.0002.
Real vortex_strength(Index N, VectorRef velocity);

// Σ m p / Σ m over the cells at p, without regard to periods, as published. Not finite where Σ m
// is 0.
Eigen::Vector2d centre_of_mass(Index N, VectorRef marker);

constexpr Real kFlowLength = 128;  // of the domain's side
constexpr Real kFlowMiddle = 64;

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

// L = (1/B) Σ Σ_k √max(|d̂_k|²/N², 1e-5), d̂ the transform of y − y*, N cells a side: the sum of the
// amplitudes of the modes, the published loss of the fluid experiment; the square, ½ Σ |d̂_k|²/N²,
// is ½‖y − y*‖².

class Amplitudes final : public Loss {
 public:
  explicit Amplitudes(Index N) : N_(N), fourier_(N, N), difference_(N * N) {}
  bool is_least_squares() const override { return false; }
  Real value(BatchRef y, BatchRef target) const override;
  void cotangent(BatchRef y, BatchRef target, BatchOut g) const override;
  void curvature(BatchRef y, BatchRef target, BatchRef dy, BatchOut dg) const override;

 private:
  static constexpr Real kLeast = 1e-5;     // of a squared amplitude
  Real amplitude(Index i, Index j) const;  // |d̂|/N of the spectrum now held
  void transform(VectorRef y, VectorRef target) const;

  Index N_;
  mutable RealFourier2d fourier_;  // its spectrum is scratch, as is this
  mutable Vector difference_;      // (N²)
  mutable Eigen::MatrixXcd held_;  // (N/2 + 1, N)
};

// The map from an initial velocity to what is seen of the marker it carries: x (2N², B) at the
// centres, context (2N², B) the marker before, and as it was observed after, which the inverse
// uses; y (N², B) the marker after the last step under the weights of the low pass. Samples are
// shared among the threads; each is computed by one, so that their number changes no bit.

// The work space of one thread.
struct FlowWorker {
  FlowWorker(const FlowOptions& options, Index steps, Track track);

  Simulation simulation;
  LowPass low_pass;
  VortexInverse vortex;
  CoarseInverse coarse;
  Vector state;  // (3N²) a tangent or cotangent
};

class FlowPhysics final : public Physics {
 public:
  enum class Back { consistent, published, coarse };  // the inverse, of the first two by its track

  FlowPhysics(const FlowOptions& options, Index steps, Back back)
      : options_(options), steps_(steps), back_(back) {}

  Index inputs() const override { return 2 * options_.cells(); }
  Index outputs() const override { return options_.cells(); }
  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const override;
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override;
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override;

  Inverse inverse_kind() const override {
    return back_ == Back::coarse ? Inverse::approximate : Inverse::estimate;
  }
  Index inverse_price() const override;
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const override;

 private:
  using Workers = std::vector<std::unique_ptr<FlowWorker>>;
  struct Own;
  void fit(Workers& workers) const;  // one for each thread

  FlowOptions options_;
  Index steps_;
  Back back_;
  mutable Workers inverting_;  // work space of local_inverse
};

// The published measure of an error: |v − v*| of velocities at the centres, from both sampled on
// the faces, what was predicted projected too, and what is true where its own solver does; the mean
// over cells and samples. Where the truth is collocated it is not 0 at x = x*.
class FlowDistance {
 public:
  FlowDistance(const FlowOptions& options, Arrangement truth);
  Real mean(BatchRef x, BatchRef truth);

 private:
  bool projects_truth_;
  FlowOptions options_;
  Simulation simulation_;
  Vector predicted_, difference_;  // (2N²) on the faces, at the centres
};

}  // namespace isoline::problems
