// The flows to be reconstructed, and the marker that shows them: Holl, Koltun, Thuerey (2022),
// published scripts of the fluid experiment, on a square of 128 by 128.
#pragma once

#include "core/array.h"
#include "core/fourier.h"
#include "core/random.h"
#include "problems/physics.h"
#include "problems/physics/flow_inverses.h"

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
// uses; y (N², B) the marker after the last step under the weights of flow_inverses.h. Samples are
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
