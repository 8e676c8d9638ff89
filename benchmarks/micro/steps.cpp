// The linear algebra that a step cannot do without, written against LAPACKE and the problem, with
// no meter and nothing checked.
#include <fmt/format.h>
#include <lapacke.h>

#include <functional>
#include <memory>
#include <string>

#include "benchmarks/micro/pairs.h"
#include "problems/problem.h"

namespace isoline::benchmarks::micro {

using problems::Problem;
using BareStep = std::function<void(Vector& theta)>;

// For a method not known here, one step of gradient descent. The problem outlives the step.
BareStep bare_step(const std::string& method, const Problem& problem);

// The linear algebra that a step cannot do without. LAPACKE is called past its door on purpose: the
// door is part of what is measured.

using problems::Inverse;
using problems::Point;
namespace {

using Pivots = Eigen::Matrix<lapack_int, Eigen::Dynamic, 1>;

lapack_int as_int(Index n) { return static_cast<lapack_int>(n); }

// What every step starts with.
struct Evaluated {
  const Problem& problem;
  Point at = {};
  Matrix g = {};         // (m, B)
  Vector gradient = {};  // (n)

  void forward(VectorRef theta) {
    problem.forward(theta, at);
    g.resize(problem.outputs(), problem.samples());
    problem.cotangent(at, g);
  }
  void pullback() {
    gradient.resize(problem.unknowns());
    problem.pullback(g, gradient, at);
  }
};

struct Descent {
  Evaluated f;

  void operator()(Vector& theta) {
    f.forward(theta);
    f.pullback();
    theta -= 1e-3 * f.gradient;
  }
};

struct Newton {
  Evaluated f;
  Matrix H = {};
  Pivots pivots = {};

  void operator()(Vector& theta) {
    f.forward(theta);
    f.pullback();
    f.problem.hessian(H, f.at);
    const lapack_int n = as_int(H.rows());
    pivots.resize(n);
    LAPACKE_dgesv(LAPACK_COL_MAJOR, n, 1, H.data(), n, pivots.data(), f.gradient.data(), n);
    theta -= f.gradient;
  }
};

struct SaddleFreeNewton {
  Evaluated f;
  Matrix H = {};
  Vector lambda = {}, along = {};

  void operator()(Vector& theta) {
    f.forward(theta);
    f.pullback();
    f.problem.hessian(H, f.at);
    const lapack_int n = as_int(H.rows());
    lambda.resize(n);
    LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'L', n, H.data(), n, lambda.data());
    along.noalias() = H.transpose() * f.gradient;
    along.array() /= lambda.array().abs();
    theta.noalias() -= H * along;
  }
};

// d = argmin ‖J d + r‖² + μ‖d‖²; no damping rows for Gauss-Newton.
struct LeastSquares {
  Evaluated f;
  bool is_damped = false;
  Matrix J = {}, augmented = {};
  Vector right = {};
  Pivots pivots = {};

  void operator()(Vector& theta) {
    f.forward(theta);
    f.problem.jacobian(J, f.at);
    const Index n = J.cols(), m = J.rows();
    const Index rows = is_damped ? m + n : m;
    right.setZero(std::max(rows, n));
    right.head(m) = (f.at.y - f.problem.target()).reshaped();
    if (is_damped) {
      augmented.setZero(rows, n);
      augmented.topRows(m) = J;
      augmented.bottomRows(n).diagonal().setConstant(1e-2);
    }
    Matrix& A = is_damped ? augmented : J;
    pivots.setZero(n);
    lapack_int rank = 0;
    LAPACKE_dgelsy(LAPACK_COL_MAJOR, as_int(rows), as_int(n), 1, A.data(), as_int(rows),
                   right.data(), as_int(right.size()), pivots.data(), 1e-14, &rank);
    theta -= right.head(n);
  }
};

struct HalfInverse {
  Evaluated f;
  Matrix J = {}, U = {}, Vt = {};
  Vector sigma = {}, along = {};

  void operator()(Vector& theta) {
    f.forward(theta);
    f.problem.jacobian(J, f.at);
    const Index m = J.rows(), n = J.cols(), r = std::min(m, n);
    U.resize(m, r);
    sigma.resize(r);
    Vt.resize(r, n);
    LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', as_int(m), as_int(n), J.data(), as_int(m), sigma.data(),
                   U.data(), as_int(m), Vt.data(), as_int(r));
    along.noalias() = U.transpose() * f.g.reshaped();
    along.array() /= sigma.array().sqrt();
    theta.noalias() -= 1e-3 * Vt.transpose() * along;
  }
};

struct InverseGradient {
  Evaluated f;
  Matrix J = {};
  Vector dy = {};
  Pivots pivots = {};

  void operator()(Vector& theta) {
    f.forward(theta);
    f.problem.jacobian(J, f.at);
    dy = (f.problem.target() - f.at.y).reshaped();
    const lapack_int n = as_int(J.rows());
    pivots.resize(n);
    LAPACKE_dgesv(LAPACK_COL_MAJOR, n, 1, J.data(), n, pivots.data(), dy.data(), n);
    theta += dy;
  }
};

// The inverse-simulator update x ← P⁻¹(y*; x), for the identity network.
struct LocalInverse {
  Evaluated f;
  Matrix found = {};  // (k, B)

  void operator()(Vector& theta) {
    f.forward(theta);
    found.resize(f.problem.inputs(), f.problem.samples());
    f.problem.local_inverse(f.problem.target(), found, f.at);
    theta = found.reshaped();
  }
};

// A std::function must be copied, which what a step has evaluated is not.
template <class Step>
BareStep shared(Step step) {
  return [own = std::make_shared<Step>(std::move(step))](Vector& theta) { (*own)(theta); };
}

}  // namespace

BareStep bare_step(const std::string& method, const Problem& problem) {
  const bool has_inverse = problem.inverse_kind() != Inverse::none;
  if (method == "newton") return shared(Newton{{problem}});
  if (method == "saddle-free-newton") return shared(SaddleFreeNewton{{problem}});
  if (method == "gauss-newton") return shared(LeastSquares{{problem}});
  if (method == "levenberg-marquardt") return shared(LeastSquares{{problem}, true});
  if (method == "hig") return shared(HalfInverse{{problem}});
  if (method == "inverse-gradient") return shared(InverseGradient{{problem}});
  if (method == "sip" && has_inverse) return shared(LocalInverse{{problem}});
  return shared(Descent{{problem}});
}

// One step of each method written here over the bare linear algebra that it needs.

using optimizers::Family;
namespace {

// Tiny, where overhead shows; middling; and two grids whose transforms allocate inside FFTW.
const char* const kProblems[] = {"rosenbrock", "broyden-tridiagonal[n=100]", "poisson[N=8]",
                                 "heat[N=8]"};

bool factorizes(const OracleSet& needs) {
  return needs.contains(Oracle::jacobian) || needs.contains(Oracle::hessian);
}

// A few steps from the start, before the method has converged; the first, untimed, sizes its state.
Cost steps_of_ours(Trial& trial, int steps) {
  Vector theta = trial.problem.start();
  trial.method->start(trial.meter, theta);
  trial.method->step(trial.meter, theta);
  return cost_of(steps, [&] { trial.method->step(trial.meter, theta); });
}

Cost bare_steps(const Problem& problem, const BareStep& step, int steps) {
  Vector theta = problem.start();
  step(theta);
  return cost_of(steps, [&] { step(theta); });
}

Pair make(const std::string& name, const std::string& problem_spec) {
  const auto problem = std::make_shared<const Problem>(make_problem(problem_spec));
  const auto trial = std::make_shared<Trial>(*problem, name, endless());
  const BareStep step = bare_step(name, *problem);
  trial->meter.begin(problem->start());
  const int steps = factorizes(needs(name, *problem)) ? 4 : 32;
  return {[=] { return steps_of_ours(*trial, steps); },
          [=] { return bare_steps(*problem, step, steps); }};
}

bool is_written_here(Family family) {
  return family == Family::first_order || family == Family::curvature ||
         family == Family::inversion;
}

}  // namespace

void register_steps() {
  for (const std::string problem_spec : kProblems) {
    const Problem problem = make_problem(problem_spec);
    for (const auto& [name, entry] : catalog().optimizers.ready()) {
      const OptionValues options = complete_optimizer(catalog(), name, OptionValues()).options;
      if (!is_written_here(entry.family)) continue;
      if (!why_inapplicable(entry, options, problem).empty()) continue;
      const int pairs = factorizes(needs(name, problem)) ? 41 : 401;
      register_pair(fmt::format("step/{}/{}", name, problem_spec), pairs, {},
                    [name = name, problem_spec] { return make(name, problem_spec); });
    }
  }
}

}  // namespace isoline::benchmarks::micro
