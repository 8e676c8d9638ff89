// The map from an initial velocity to what is seen of the marker it carries: x (2N², B) at the
// centres, context (2N², B) the marker before, and as it was observed after, which the inverse
// uses; y (N², B) the marker after the last step under the weights of low_pass.h. Samples are
// shared among the threads; each is computed by one, so that their number changes no bit.
#pragma once

#include "problems/physics.h"
#include "problems/physics/coarse_inverse.h"
#include "problems/physics/vortex_inverse.h"

namespace isoline::problems {

// What one thread computes with.
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
