// One step of the training methods on a mini-batch: over a step of Adam on the same problem, and of
// half-inverse gradients over the Gram product and eigendecomposition that it cannot do without.
#include <cblas.h>
#include <lapacke.h>

#include "benchmarks/micro/pairs.h"
#include "problems/dense_physics.h"

namespace isoline::benchmarks::micro {

using networks::make_network;
using problems::DensePhysics;
namespace {

// A few steps at a time, or the scheduler of a busy machine would interrupt each reading.
constexpr int kSteps = 4, kPairs = 601;

// A method that has taken its first steps, which size its state.
struct Underway {
  Underway(const Problem& problem, const std::string& spec)
      : trial(problem, spec, endless()), theta(problem.start()) {
    trial.meter.begin(theta);
    trial.method->start(trial.meter, theta);
    run();
  }
  Cost run() {
    return cost_of(kSteps, [this] { trial.method->step(trial.meter, theta); });
  }

  Trial trial;
  Vector theta;
};

void add_over_adam(const std::string& problem_spec, const std::string& spec, const Goal& goal) {
  register_pair("training/" + spec + "/" + problem_spec, kPairs, goal, [=] {
    const auto problem = std::make_shared<const Problem>(make_problem(problem_spec));
    const auto ours = std::make_shared<Underway>(*problem, spec);
    const auto adam = std::make_shared<Underway>(*problem, "adam");
    return Pair{[problem, ours] { return ours->run(); }, [=] { return adam->run(); }};
  });
}

class Unchanged final : public DensePhysics {  // y = x
 public:
  Unchanged() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override { y = x; }
  void derivative(VectorRef, BatchOut J) const override { J.setIdentity(); }
};

// ŷ(t) = (sin 6t, cos 9t) by 7 tanh neurons, 30 parameters, 256 samples.
Problem toy() {
  auto network = make_network("mlp[layers=7,activation=tanh]", {.inputs = 1, .outputs = 2});
  constexpr Index kSamples = 256;
  const Matrix t = Vector::LinSpaced(kSamples, -1, 1).transpose();
  Matrix target(2, kSamples);
  target << (6 * t.array()).sin().matrix(), (9 * t.array()).cos().matrix();
  RandomStream stream(0, "toy", "network");
  const Vector start = network->start(stream);
  return Problem({.physics = std::make_unique<Unchanged>(),
                  .start = start,
                  .target = target,
                  .network = std::move(network),
                  .input = t,
                  .minimum = 0});
}

// JᵀJ = V diag(λ) Vᵀ of the toy's J, (512, 30).
struct BareGram {
  explicit BareGram(const Problem& problem) {
    Point at;
    problem.forward(problem.start(), at);
    problem.jacobian(J, at);
    gram.resize(J.cols(), J.cols());
    lambda.resize(J.cols());
  }
  Cost run() {
    return cost_of(kSteps, [this] {
      const int m = static_cast<int>(J.rows()), n = static_cast<int>(J.cols());
      cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, n, m, 1, J.data(), m, 0, gram.data(), n);
      LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'L', n, gram.data(), n, lambda.data());
    });
  }

  Matrix J, gram;
  Vector lambda;
};

}  // namespace

void register_training() {
  const std::string sine = "sine[mode=learn,xi=32]";
  const std::string in_double = "sine[mode=learn,xi=32,network=mlp[precision=double]]";
  for (const std::string& problem : {sine, in_double}) {
    for (const char* spec : {"sip[inverse=newton,proxy=l1]", "sip[inverse=analytic]"})
      add_over_adam(problem, spec, {.ratio = 1.15});
    add_over_adam(problem, "adahessian", {.ratio = 4});
    for (const char* spec : {"supervised", "kfac"}) add_over_adam(problem, spec, {});
  }
  register_pair("training/hig/toy", kPairs, {.ratio = 2}, [] {
    const auto problem = std::make_shared<const Problem>(toy());
    const auto ours = std::make_shared<Underway>(*problem, "hig");
    const auto bare = std::make_shared<BareGram>(*problem);
    return Pair{[problem, ours] { return ours->run(); }, [=] { return bare->run(); }};
  });
}

}  // namespace isoline::benchmarks::micro
