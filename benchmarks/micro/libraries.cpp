// Ceres and NLopt through us over their plain use, on the same problem without a meter, for the
// same iterations. `recorded` is the time a record shows; `whole` includes what the harness does
// off the clock. Includes the libraries' headers without their adapters, for the plain side only.
#include <ceres/ceres.h>
#include <glog/logging.h>
#include <nlopt.h>

#include <cmath>

#include "benchmarks/micro/pairs.h"
#include "benchmarks/run/execute.h"

namespace isoline::benchmarks::micro {
namespace {

using Eigen::Map;
constexpr const char* kProblem = "broyden-tridiagonal[n=1000]";

// The problem as a careful user of a library would call it.
struct Plain {
  const Problem& problem;
  mutable Point at = {};
  mutable Matrix J = {}, g = {};

  double loss(const double* x, double* gradient) const {
    const Index n = problem.unknowns();
    problem.forward(Map<const Vector>(x, n), at);
    if (!gradient) return at.loss;
    g.resize(problem.outputs(), problem.samples());
    problem.cotangent(at, g);
    problem.pullback(g, Map<Vector>(gradient, n), at);
    return at.loss;
  }
};

struct PlainResiduals final : ceres::CostFunction {
  Plain plain;

  explicit PlainResiduals(const Problem& problem) : plain{problem} {
    set_num_residuals(static_cast<int>(problem.residuals()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.unknowns()));
  }
  bool Evaluate(double const* const* x, double* r, double** out) const override {
    using RowMajor = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    plain.loss(x[0], nullptr);
    plain.problem.residual(plain.at, Map<Vector>(r, num_residuals()));
    if (!out || !out[0]) return true;
    plain.problem.jacobian(plain.J, plain.at);
    Map<RowMajor>(out[0], plain.J.rows(), plain.J.cols()) = plain.J;
    return true;
  }
};

struct PlainLoss final : ceres::FirstOrderFunction {
  Plain plain;

  explicit PlainLoss(const Problem& problem) : plain{problem} {}
  int NumParameters() const override { return static_cast<int>(plain.problem.unknowns()); }
  bool Evaluate(const double* x, double* loss, double* gradient) const override {
    *loss = plain.loss(x, gradient);
    return true;
  }
};

template <class Options>
Options plain_options(int iterations) {
  FLAGS_minloglevel = google::GLOG_FATAL;
  Options options;
  options.max_num_iterations = iterations;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0;
  options.logging_type = ceres::SILENT;
  return options;
}

void plain_ceres_lm(const Problem& problem, int iterations) {
  Vector x = problem.start();
  auto options = plain_options<ceres::Solver::Options>(iterations);
  options.linear_solver_type = ceres::DENSE_QR;
  ceres::Problem blocks;
  blocks.AddResidualBlock(new PlainResiduals(problem), nullptr, x.data());
  ceres::Solver::Summary summary;
  ceres::Solve(options, &blocks, &summary);
}

void plain_ceres_lbfgs(const Problem& problem, int iterations) {
  Vector x = problem.start();
  auto options = plain_options<ceres::GradientProblemSolver::Options>(iterations);
  options.line_search_direction_type = ceres::LBFGS;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, ceres::GradientProblem(new PlainLoss(problem)), x.data(), &summary);
}

// For as many evaluations: NLopt counts no iterations.
void plain_nlopt_lbfgs(const Problem& problem, int evaluations) {
  Plain plain{problem};
  Vector x = problem.start();
  const nlopt_opt search = nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(x.size()));
  const auto evaluate = [](unsigned, const double* at, double* gradient, void* self) {
    return static_cast<Plain*>(self)->loss(at, gradient);
  };
  nlopt_set_min_objective(search, evaluate, &plain);
  nlopt_set_maxeval(search, evaluations);
  nlopt_set_vector_storage(search, 100);  // as ours by default
  double loss = 0;
  nlopt_optimize(search, x.data(), &loss);
  nlopt_destroy(search);
}

struct Library {
  const char* name;
  int iterations, calls, pairs;  // calls: solves timed at once
  void (*plain)(const Problem& problem, int iterations);
  bool counts_evaluations = false;  // of the plain solve
};

const Library kLibraries[] = {
    {"ceres-lm", 2, 1, 3, plain_ceres_lm},
    {"ceres-lbfgs", 20, 10, 101, plain_ceres_lbfgs},
    {"nlopt-lbfgs", 20, 10, 101, plain_nlopt_lbfgs, true},
};

void solve(Trial& trial) {
  Checkpoint nothing;
  drive(*trial.method, trial.meter, trial.problem.start(), nothing);
}

// The mean time of solves that starts afresh, by the record's clock or by ours.
Cost solves_of_ours(const Problem& problem, const Library& library, bool is_recorded) {
  Budget budget = endless();
  budget.iterations = library.iterations;
  Cost sum;
  for (int call = 0; call < library.calls; ++call) {
    Trial trial(problem, library.name, budget);
    const Cost cost = cost_of(1, [&] { solve(trial); });
    sum.seconds += is_recorded ? trial.trace.last.wall_seconds : cost.seconds;
  }
  return {sum.seconds / library.calls};
}

int evaluations_of_ours(const Problem& problem, const Library& library) {
  Budget budget = endless();
  budget.iterations = library.iterations;
  const auto trial = std::make_unique<Trial>(problem, library.name, budget);
  solve(*trial);
  return static_cast<int>(trial->trace.last.counts[static_cast<std::size_t>(Oracle::forward)]);
}

Pair make(const Library& library, bool is_recorded) {
  const auto problem = std::make_shared<const Problem>(make_problem(kProblem));
  const int count =
      library.counts_evaluations ? evaluations_of_ours(*problem, library) : library.iterations;
  return {[=] { return solves_of_ours(*problem, library, is_recorded); },
          [=] { return cost_of(library.calls, [&] { library.plain(*problem, count); }); }};
}

}  // namespace

void register_libraries() {
  for (const Library& library : kLibraries) {
    const std::string name = std::string("library/") + library.name;
    register_pair(name + "/recorded", library.pairs, {.ratio = 1.1},
                  [=] { return make(library, true); });
    register_pair(name + "/whole", library.pairs, {}, [=] { return make(library, false); });
  }
}

}  // namespace isoline::benchmarks::micro
