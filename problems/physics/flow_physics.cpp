// Random flows and markers.
#include "problems/physics/flow_physics.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "core/decompose.h"
#include "core/threads.h"
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

// The sum of amplitudes. Of the half spectrum that is kept, a mode stands for its conjugate too,
// except in the first column and, N being even, in the last.

Real Amplitudes::amplitude(Index i, Index j) const {
  return std::abs(fourier_.spectrum()(i, j)) / static_cast<Real>(N_);
}

void Amplitudes::transform(VectorRef y, VectorRef target) const {
  difference_ = y - target;
  fourier_.forward(difference_);
}

Real Amplitudes::value(BatchRef y, BatchRef target) const {
  Real sum = 0;
  for (Index b = 0; b < y.cols(); ++b) {
    transform(y.col(b), target.col(b));
    for (Index j = 0; j < N_; ++j)
      for (Index i = 0; i <= N_ / 2; ++i) {
        const Real of_mode = amplitude(i, j);
        const Real held = of_mode * of_mode < kLeast ? std::sqrt(kLeast) : of_mode;
        sum += (i == 0 || 2 * i == N_ ? 1 : 2) * held;
      }
  }
  return sum / static_cast<Real>(y.cols());
}

// The transpose of the transform turns the phases back into cells.
void Amplitudes::cotangent(BatchRef y, BatchRef target, BatchOut g) const {
  for (Index b = 0; b < y.cols(); ++b) {
    transform(y.col(b), target.col(b));
    for (Index j = 0; j < N_; ++j)
      for (Index i = 0; i <= N_ / 2; ++i) {
        const Real of_mode = amplitude(i, j);
        const bool is_held = of_mode * of_mode < kLeast;
        fourier_.spectrum()(i, j) *= is_held ? 0 : 1 / (of_mode * static_cast<Real>(N_));
      }
    fourier_.inverse(g.col(b));
  }
  g /= static_cast<Real>(y.cols() * N_);
}

// The second derivative of |d̂| is the part of a change across the phase, over |d̂|.
void Amplitudes::curvature(BatchRef y, BatchRef target, BatchRef dy, BatchOut dg) const {
  for (Index b = 0; b < y.cols(); ++b) {
    transform(y.col(b), target.col(b));
    held_ = fourier_.spectrum();
    fourier_.forward(dy.col(b));
    for (Index j = 0; j < N_; ++j)
      for (Index i = 0; i <= N_ / 2; ++i) {
        std::complex<Real>& change = fourier_.spectrum()(i, j);
        const std::complex<Real> d = held_(i, j);
        const Real size = std::abs(d), of_mode = size / static_cast<Real>(N_);
        if (of_mode * of_mode < kLeast)
          change = 0;
        else
          change = (change - d * (std::real(std::conj(d) * change) / (size * size))) / size;
      }
    fourier_.inverse(dg.col(b));
  }
  dg /= static_cast<Real>(y.cols() * N_);
}

// The flow of a batch.

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

  template <class Visit>
  void each_sample(const Visit& visit) {
    for_each_task(static_cast<Index>(runs.size()), [&](Index b, int thread) {
      visit(*workers[static_cast<std::size_t>(thread)], runs[static_cast<std::size_t>(b)], b);
    });
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
  own.each_sample([&](FlowWorker& worker, FlowRun& run, Index b) {
    worker.simulation.begin(x.col(b), c.col(b).head(cells), run);
    worker.simulation.forward(run);
    worker.low_pass.apply(run.marker(steps_), y.col(b));
  });
}

void FlowPhysics::pushforward(BatchRef v, BatchOut Jv, Workspace& w) const {
  Own& own = w.as<Own>();
  const Index cells = options_.cells();
  own.each_sample([&](FlowWorker& worker, const FlowRun& run, Index b) {
    worker.simulation.begin_pushforward(v.col(b), worker.state.head(2 * cells));
    worker.state.tail(cells).setZero();
    worker.simulation.pushforward(run, worker.state);
    worker.low_pass.apply(worker.state.tail(cells), Jv.col(b));
  });
}

void FlowPhysics::pullback(BatchRef u, BatchOut JTu, Workspace& w) const {
  Own& own = w.as<Own>();
  const Index cells = options_.cells();
  own.each_sample([&](FlowWorker& worker, const FlowRun& run, Index b) {
    worker.state.head(2 * cells).setZero();
    worker.low_pass.apply(u.col(b), worker.state.tail(cells));
    worker.simulation.pullback(run, worker.state);
    worker.simulation.begin_pullback(worker.state.head(2 * cells), JTu.col(b));
  });
}

// A run forward and one back; or, per step of the search, a run, the modes, and a trial.
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

// The inverses: Gauss-Newton over a few coarse modes; translation and vortex, estimated.

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
