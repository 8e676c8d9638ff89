// The door to Ceres (Agarwal, Mierle et al., ceres-solver.org): its trust-region methods on r = (y
// − y*)/√B, with dense QR, and its line searches on L. Ceres keeps its own loop; each of its
// iterations, rejected ones too, is reported to the meter. All its tolerances are zero, so that of
// its own it stops only where a step changes nothing in floating point.
#include <ceres/ceres.h>
#include <glog/logging.h>

#include <cmath>
#include <exception>
#include <limits>

#include "optimizers/optimizer.h"

namespace isoline {
namespace {

using Eigen::Map;
using TrustRegionSetup = void (*)(const Json& options, ceres::Solver::Options&);

// What Ceres asks of one θ, in several calls, costs one forward pass. No exception crosses Ceres:
// it is kept and thrown again after the solve.
struct Evaluation {
  Meter& f;
  Vector theta;  // (n)
  Linearization point = {};
  bool has_point = false;
  std::exception_ptr error = nullptr;

  // Runs `read` on the linearization at θ; false where the run is over or something is not finite.
  template <class Read>
  bool at(const double* parameters, Read read) {
    if (error || f.is_spent() || f.status() != Status::running) return false;
    theta = Map<const Vector>(parameters, theta.size());  // aligned, whatever Ceres' array is
    if (!theta.allFinite()) return false;
    try {
      if (!has_point || theta != point.theta()) f.linearize(theta, point);
      has_point = true;
      read(point);
    } catch (...) {
      error = std::current_exception();
      return false;
    }
    return std::isfinite(point.loss());
  }
};

// r and its Jacobian as one block of n parameters.
class ResidualBlock final : public ceres::CostFunction {
 public:
  explicit ResidualBlock(Evaluation& evaluation) : evaluation_(evaluation) {
    set_num_residuals(static_cast<int>(evaluation.f.residuals()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluation.f.unknowns()));
  }
  bool Evaluate(double const* const* theta, double* r, double** J) const override {
    using RowMajor = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return evaluation_.at(theta[0], [&](Linearization& at) {
      at.residual(residual_);
      Map<Vector>(r, residual_.size()) = residual_;
      if (!J || !J[0]) return;
      const Real scale = 1 / std::sqrt(static_cast<Real>(evaluation_.f.samples()));
      Map<RowMajor>(J[0], residual_.size(), at.theta().size()) = scale * at.jacobian();
    });
  }

 private:
  Evaluation& evaluation_;
  mutable Vector residual_;  // (m·B)
};

// L and its gradient.
class LossFunction final : public ceres::FirstOrderFunction {
 public:
  explicit LossFunction(Evaluation& evaluation) : evaluation_(evaluation) {}
  int NumParameters() const override { return static_cast<int>(evaluation_.f.unknowns()); }
  bool Evaluate(const double* theta, double* loss, double* gradient) const override {
    return evaluation_.at(theta, [&](Linearization& at) {
      *loss = at.loss();
      if (!gradient) return;
      at.gradient(gradient_);
      Map<Vector>(gradient, gradient_.size()) = gradient_;
    });
  }

 private:
  Evaluation& evaluation_;
  mutable Vector gradient_;  // (n)
};

// Reports each iteration; Ceres has then updated θ.
class Watch final : public ceres::IterationCallback {
 public:
  Watch(Meter& f, const Vector& theta) : f_(f), theta_(theta) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0) return ceres::SOLVER_CONTINUE;  // the start
    if (!summary.step_is_successful) f_.reject_step();
    return f_.iterate(theta_) == Status::running ? ceres::SOLVER_CONTINUE
                                                 : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  Meter& f_;
  const Vector& theta_;
};

template <class Options>
void set_common(Options& options, Watch& watch) {
  FLAGS_minloglevel =
      google::GLOG_FATAL;  // Ceres warns on standard error of what is ours to record
  options.max_num_iterations = std::numeric_limits<int>::max();
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  options.callbacks.push_back(&watch);
}

template <class Summary>
Status verdict(const Evaluation& evaluation, const Summary& summary) {
  if (evaluation.error) std::rethrow_exception(evaluation.error);
  Meter& f = evaluation.f;
  f.claim(summary.message);
  if (f.status() != Status::running) return f.status();
  if (f.is_spent()) return Status::budget;
  return summary.termination_type == ceres::CONVERGENCE ? Status::converged : Status::stalled;
}

Status solve(const ceres::Solver::Options& options, Evaluation& evaluation, Vector& theta) {
  ceres::Problem problem;  // owns the block
  problem.AddResidualBlock(new ResidualBlock(evaluation), nullptr, theta.data());
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return verdict(evaluation, summary);
}

Status solve(const ceres::GradientProblemSolver::Options& options, Evaluation& evaluation,
             Vector& theta) {
  const ceres::GradientProblem problem(new LossFunction(evaluation));  // owns the function
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, theta.data(), &summary);
  return verdict(evaluation, summary);
}

// Options: of Ceres' trust-region solver, or of its line searches.
template <class Options>
class Ceres final : public Optimizer {
 public:
  explicit Ceres(Options options) : options_(std::move(options)) {}
  void start(Meter&, const Vector&) override {}
  bool reports_iterations() const override { return true; }
  Status step(Meter& f, Vector& theta) override {
    Evaluation evaluation{f, theta};
    Watch watch(f, theta);
    Options options = options_;
    set_common(options, watch);
    return solve(options, evaluation, theta);
  }

 private:
  const Options options_;
};

struct Radius {
  Real initial_radius = 1e4;
};
void fields(Radius& o, auto& field) {
  field("initial-radius", o.initial_radius, above(0), "trust radius at the start, Ceres' default");
}

OptimizerEntry trust_region(OptimizerEntry entry, TrustRegionSetup setup) {
  entry.family = Family::ceres;
  entry.needs = {Oracle::forward, Oracle::jacobian};
  entry.most_unknowns = 4096;
  entry.most_rank = 2048;  // dense QR
  entry.make = [setup](const Json& json, const OptimizerRegistry&) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    setup(json, options);
    return std::make_unique<Ceres<ceres::Solver::Options>>(options);
  };
  return entry;
}

void set_radius(const Json& json, ceres::Solver::Options& o) {
  o.initial_trust_region_radius = read_options<Radius>(json).initial_radius;
}

void add_trust_regions(OptimizerRegistry& registry) {
  registry.add(
      trust_region({.name = "ceres-gauss-newton",
                    .title = "Gauss-Newton, safeguarded (Ceres)",
                    .formula = "θ ← θ − J⁺ (y − y*)",
                    .source = "Ceres 2.1, Levenberg-Marquardt with its trust radius opened to 1e16",
                    .note = "Steps that raise the loss are still rejected, then damped.",
                    .is_input_scale_invariant = true},
                   [](const Json&, ceres::Solver::Options& o) {
                     o.initial_trust_region_radius = o.max_trust_region_radius;
                     o.min_relative_decrease = 0;
                   }));
  registry.add(trust_region({.name = "ceres-lm",
                             .title = "Levenberg-Marquardt (Ceres)",
                             .formula = "θ ← θ − (JᵀJ + D²/Δ)⁻¹ Jᵀ r,  D² = diag(JᵀJ)",
                             .source = "Ceres 2.1; Marquardt (1963), Nielsen (1999)",
                             .options = option_table<Radius>()},
                            set_radius));
  registry.add(trust_region(
      {.name = "ceres-dogleg",
       .title = "Powell's dogleg (Ceres)",
       .formula = "min ‖r + J d‖² along the path to steepest descent, then to Gauss-Newton",
       .source = "Ceres 2.1; Powell (1970)",
       .note = "Invariant while its Gauss-Newton steps lie within the radius.",
       .is_input_scale_invariant = true,
       .options = option_table<Radius>()},
      [](const Json& json, ceres::Solver::Options& o) {
        o.trust_region_strategy_type = ceres::DOGLEG;
        set_radius(json, o);
      }));
  registry.add(trust_region(
      {.name = "ceres-subspace-dogleg",
       .title = "Subspace dogleg (Ceres)",
       .formula = "min ‖r + J d‖² over the plane of steepest descent and Gauss-Newton, ‖D d‖ ≤ Δ",
       .source = "Ceres 2.1; Byrd, Schnabel, Shultz (1988)",
       .note = "Invariant while its Gauss-Newton steps lie within the radius.",
       .is_input_scale_invariant = true,
       .options = option_table<Radius>()},
      [](const Json& json, ceres::Solver::Options& o) {
        o.trust_region_strategy_type = ceres::DOGLEG;
        o.dogleg_type = ceres::SUBSPACE_DOGLEG;
        set_radius(json, o);
      }));
}

struct LineSearch {
  ceres::LineSearchDirectionType direction;
  const char *name, *title, *formula, *source;
  Index most_unknowns = std::numeric_limits<Index>::max();
};

const LineSearch kLineSearches[] = {
    {ceres::STEEPEST_DESCENT, "ceres-steepest-descent", "Steepest descent with line search (Ceres)",
     "θ ← θ − α ∇L,  α by the Wolfe conditions",
     "Ceres 2.1; Nocedal, Wright (2006), algorithm 3.5"},
    {ceres::NONLINEAR_CONJUGATE_GRADIENT, "ceres-ncg", "Nonlinear conjugate gradients (Ceres)",
     "d ← −∇L + β d,  β = ‖∇L‖²/‖∇L₋‖²,  θ ← θ + α d", "Ceres 2.1; Fletcher, Reeves (1964)"},
    {ceres::BFGS, "ceres-bfgs", "BFGS (Ceres)",
     "θ ← θ − α B ∇L,  B ≈ H⁻¹ by rank-two updates, dense",
     "Ceres 2.1; Nocedal, Wright (2006), algorithm 6.1", 2048},
    {ceres::LBFGS, "ceres-lbfgs", "Limited-memory BFGS (Ceres)",
     "θ ← θ − α B ∇L,  B ≈ H⁻¹ from the last 20 steps", "Ceres 2.1; Nocedal (1980)"},
};

OptimizerEntry entry_of(const LineSearch& method) {
  return {.name = method.name,
          .title = method.title,
          .family = Family::ceres,
          .formula = method.formula,
          .source = method.source,
          .needs = {Oracle::forward, Oracle::pullback},
          .most_unknowns = method.most_unknowns,
          .make = [direction = method.direction](const Json&, const OptimizerRegistry&) {
            ceres::GradientProblemSolver::Options options;
            options.line_search_direction_type = direction;
            return std::make_unique<Ceres<ceres::GradientProblemSolver::Options>>(options);
          }};
}

}  // namespace

void register_ceres(OptimizerRegistry& registry) {
  add_trust_regions(registry);
  for (const LineSearch& method : kLineSearches) registry.add(entry_of(method));
}

}  // namespace isoline
