// The flow of a batch.
#include "problems/physics/flow_physics.h"

#include <cmath>

#include "core/threads.h"
#include "problems/physics/flow_samples.h"
#include "problems/physics/neighbours.h"

namespace isoline::problems {

FlowWorker::FlowWorker(const FlowOptions& options, Index steps, Track track)
    : simulation(options, steps),
      low_pass(options.N),
      vortex(options.N, steps, options.dt * static_cast<Real>(steps), track),
      coarse(options.N),
      state(3 * options.cells()) {}

struct FlowPhysics::Own final : Scratch, Pieces {
  void add_choices(PieceDigest& digest) override {
    for (const FlowRun& run : runs) workers[0]->simulation.add_choices(run, digest);
  }

  Workers workers;
  std::vector<FlowRun> runs;  // of each sample
};

// FFTW plans on one thread only.
void FlowPhysics::fit(Workers& workers) const {
  const Track track = back_ == Back::published ? Track::published : Track::consistent;
  while (workers.size() < static_cast<std::size_t>(library_threads()))
    workers.push_back(std::make_unique<FlowWorker>(options_, steps_, track));
}

void FlowPhysics::forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const {
  Own& own = w.as<Own>();
  fit(own.workers);
  own.runs.resize(static_cast<std::size_t>(x.cols()));
  const Index cells = options_.cells();
  for_each_task(x.cols(), [&](Index b, int thread) {
    FlowWorker& worker = *own.workers[static_cast<std::size_t>(thread)];
    FlowRun& run = own.runs[static_cast<std::size_t>(b)];
    worker.simulation.begin(x.col(b), c.col(b).head(cells), run);
    worker.simulation.forward(run);
    worker.low_pass.apply(run.marker(steps_), y.col(b));
  });
}

void FlowPhysics::pushforward(BatchRef v, BatchOut Jv, Workspace& w) const {
  Own& own = w.as<Own>();
  const Index cells = options_.cells();
  for_each_task(v.cols(), [&](Index b, int thread) {
    FlowWorker& worker = *own.workers[static_cast<std::size_t>(thread)];
    worker.simulation.begin_pushforward(v.col(b), worker.state.head(2 * cells));
    worker.state.tail(cells).setZero();
    worker.simulation.pushforward(own.runs[static_cast<std::size_t>(b)], worker.state);
    worker.low_pass.apply(worker.state.tail(cells), Jv.col(b));
  });
}

void FlowPhysics::pullback(BatchRef u, BatchOut JTu, Workspace& w) const {
  Own& own = w.as<Own>();
  const Index cells = options_.cells();
  for_each_task(u.cols(), [&](Index b, int thread) {
    FlowWorker& worker = *own.workers[static_cast<std::size_t>(thread)];
    worker.state.head(2 * cells).setZero();
    worker.low_pass.apply(u.col(b), worker.state.tail(cells));
    worker.simulation.pullback(own.runs[static_cast<std::size_t>(b)], worker.state);
    worker.simulation.begin_pullback(worker.state.head(2 * cells), JTu.col(b));
  });
}

// A run forward and one back; or of each step of the search a run, the modes, and a trial.
Index FlowPhysics::inverse_price() const {
  return back_ == Back::coarse ? CoarseInverse::kSteps * (2 + CoarseInverse::kModes) : 2;
}

Success FlowPhysics::local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const {
  fit(inverting_);
  const Index cells = options_.cells();
  Success success(y.cols());
  for_each_task(y.cols(), [&](Index b, int thread) {
    FlowWorker& worker = *inverting_[static_cast<std::size_t>(thread)];
    const VectorRef first = c.col(b).head(cells), last = c.col(b).tail(cells);
    success[b] = back_ == Back::coarse
                     ? worker.coarse.invert(worker.simulation, worker.low_pass, x0.col(b), first,
                                            y.col(b), x.col(b))
                     : worker.vortex.invert(worker.simulation, x0.col(b), first, last, x.col(b));
  });
  return success;
}

FlowDistance::FlowDistance(const FlowOptions& options, Arrangement truth)
    : projects_truth_(truth == Arrangement::staggered),
      options_(options),
      simulation_(options, 1),
      predicted_(2 * options.cells()),
      difference_(2 * options.cells()) {}

Real FlowDistance::mean(BatchRef x, BatchRef truth) {
  const Index N = options_.N, cells = options_.cells();
  Real sum = 0;
  for (Index b = 0; b < x.cols(); ++b) {
    if (projects_truth_) {
      difference_ = x.col(b) - truth.col(b);
      simulation_.begin_pushforward(difference_, predicted_);
    } else {
      simulation_.begin_pushforward(x.col(b), predicted_);
      add_weighed(N, -0.5, -0.5, Side::left, truth.col(b).head(cells), predicted_.head(cells));
      add_weighed(N, -0.5, -0.5, Side::below, truth.col(b).tail(cells), predicted_.tail(cells));
    }
    simulation_.centre(predicted_, difference_);
    sum += difference_.reshaped(cells, 2).rowwise().norm().sum();
  }
  return sum / static_cast<Real>(x.cols() * cells);
}

}  // namespace isoline::problems
