// The adapter to Ceres (Agarwal, Mierle et al., ceres-solver.org): its trust-region methods on r =
// (y − y*)/√B, with dense QR, or by residual blocks where the Jacobian is sparse, and its line
// searches on L. Each iteration of its own loop, rejected or not, is reported to the meter. Its
// tolerances are options, 0 by default: it stops where a step changes nothing.
#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

using Eigen::Map;

// Several calls of Ceres at one θ cost one forward pass. No exception crosses Ceres: it is stored
// and thrown again after the solve.
struct Evaluation {
  Meter& f;
  Vector theta;             // (n)
  Vector point_theta = {};  // (n), where `point` is; empty: nowhere yet
  Linearization point = {};
  std::exception_ptr error = nullptr;

  // Calls `read` with the linearization at θ; false if the run is over or a value is not finite.
  template <class Read>
  bool at(const double* parameters, Read read) {
    if (error || f.is_spent() || f.status() != Status::running) return false;
    theta = Map<const Vector>(parameters, theta.size());  // aligned, whatever Ceres' array is
    if (!is_finite(theta)) return false;
    try {
      if (point_theta.size() == 0 || point_theta != theta) f.linearize(point_theta = theta, point);
      read(point);
    } catch (const BudgetSpent&) {  // which the meter records
      return false;
    } catch (...) {
      error = std::current_exception();
      return false;
    }
    return std::isfinite(point.loss());
  }
};

// All residual blocks: one call of the problem at a point fills them. Where J is dense, each
// residual is a block, as in Ceres' own program for NIST's data.
struct SharedBlocks final : ceres::EvaluationCallback {
  Evaluation& evaluation;
  const Vector& theta;  // (n), where Ceres puts the point before it calls
  Vector residual;      // (m·B)
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> dense;  // (m·B, n)
  const Real* values = nullptr;                                                // J's, by rows
  bool is_evaluated = false;

  SharedBlocks(Evaluation& shared, const Vector& parameters)
      : evaluation(shared), theta(parameters) {}
  void PrepareForEvaluation(bool with_jacobian, bool) override {
    is_evaluated = evaluation.at(theta.data(), [&](Linearization& at) {
      const Real unit = evaluation.f.residual_unit();
      at.residual(residual);
      residual *= unit;
      if (!with_jacobian) return;
      if (evaluation.f.is_sparse()) {
        values = at.sparse_jacobian().data();
      } else {
        dense = unit * at.jacobian() / std::sqrt(static_cast<Real>(evaluation.f.samples()));
        values = dense.data();
      }
    });
  }
};

// One of them: rows of r, and J's values by parameter blocks.
struct SharedBlock final : ceres::CostFunction {
  const SharedBlocks& all;
  int first_row, first_value, width = 0;

  SharedBlock(const SharedBlocks& shared, int row, int rows, int value,
              const std::vector<int>& sizes)
      : all(shared), first_row(row), first_value(value) {
    set_num_residuals(rows);
    *mutable_parameter_block_sizes() = sizes;
    width = std::accumulate(sizes.begin(), sizes.end(), 0);
  }
  bool Evaluate(double const* const*, double* r, double** J) const override {
    if (!all.is_evaluated) return false;
    for (int i = 0; i < num_residuals(); ++i) r[i] = all.residual[first_row + i];
    if (!J) return true;
    int offset = 0;
    for (std::size_t b = 0; b < parameter_block_sizes().size(); ++b) {
      const int size = parameter_block_sizes()[b];
      for (int i = 0; J[b] && i < num_residuals(); ++i)
        std::copy_n(all.values + first_value + i * width + offset, size, J[b] + i * size);
      offset += size;
    }
    return true;
  }
};

// L and its gradient. A point fails as a whole where a gradient overflows beside a finite L: Ceres'
// search for the Wolfe conditions aborts the process at such a point, but steps back from a failed
// one.
struct LossFunction final : ceres::FirstOrderFunction {
  Evaluation& evaluation;
  mutable Vector slope;  // (n), ∇L

  explicit LossFunction(Evaluation& shared) : evaluation(shared) {}
  int NumParameters() const override { return static_cast<int>(evaluation.f.unknowns()); }
  bool Evaluate(const double* theta, double* loss, double* gradient) const override {
    slope.setZero();
    const bool is_known = evaluation.at(theta, [&](Linearization& at) {
      const Real unit = evaluation.f.residual_unit();
      *loss = unit * unit * at.loss();
      if (!gradient) return;
      at.gradient(slope);
      slope *= unit * unit;
      Map<Vector>(gradient, slope.size()) = slope;
    });
    return is_known && is_finite(slope);
  }
};

// Reports each iteration; Ceres has then updated θ.
struct Watch final : ceres::IterationCallback {
  Meter& f;
  const Vector& theta;
  Vector last;  // (n), θ after the last iteration

  Watch(Meter& meter, const Vector& current) : f(meter), theta(current), last(current) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0) return ceres::SOLVER_CONTINUE;  // the start
    if (!summary.step_is_successful) f.reject_step();
    last = theta;
    return f.iterate(theta) == Status::running ? ceres::SOLVER_CONTINUE
                                               : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }
};

template <class Options>
void set_common(Options& options, Watch& watch) {
  FLAGS_minloglevel = google::GLOG_FATAL;  // our record states Ceres' warnings
  options.max_num_iterations = std::numeric_limits<int>::max();
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  options.callbacks.push_back(&watch);
}

template <class Summary>
Status verdict(const Evaluation& evaluation, const Summary& summary) {
  if (evaluation.error) std::rethrow_exception(evaluation.error);
  Meter& f = evaluation.f;
  const bool was_stopped = f.is_spent() || f.status() != Status::running;  // by us
  f.claim(was_stopped ? "stopped" : summary.message);
  if (f.status() != Status::running) return f.status();
  if (f.is_spent()) return Status::budget;
  return summary.termination_type == ceres::CONVERGENCE ? Status::converged : Status::stalled;
}

// The linear solvers for a sparse Jacobian, by the names of the option.
constexpr std::pair<const char*, ceres::LinearSolverType> kSparseSolvers[] = {
    {"sparse-normal-cholesky", ceres::SPARSE_NORMAL_CHOLESKY},
    {"sparse-schur", ceres::SPARSE_SCHUR},
    {"dense-schur", ceres::DENSE_SCHUR},
    {"iterative-schur", ceres::ITERATIVE_SCHUR}};

// As the option names it, or by the declaration of the problem; no pattern: J is dense.
std::string linear_solver_of(const std::string& option, const SparsePattern* pattern) {
  constexpr int kMostDense = 2048;  // unknowns that are kept
  if (!option.empty()) return option;
  if (!pattern) return "dense-qr";
  if (!pattern->has_eliminated()) return "sparse-normal-cholesky";
  const int kept = pattern->parameter_block[static_cast<std::size_t>(pattern->first_eliminated)];
  return kept <= kMostDense ? "dense-schur" : "sparse-schur";
}

// The bounds of `count` unknowns from `first` on, which Ceres has at `place`.
void set_bounds(const Bounds& bounds, Index first, int count, double* place,
                ceres::Problem& problem) {
  for (int i = 0; i < count; ++i) {
    const Real lower = bounds.lower[first + i], upper = bounds.upper[first + i];
    if (std::isfinite(lower)) problem.SetParameterLowerBound(place, i, lower);
    if (std::isfinite(upper)) problem.SetParameterUpperBound(place, i, upper);
  }
}

// The blocks of a dense J: a residual each, all of one block of n parameters.
void add_rows(const SharedBlocks& shared, Evaluation& evaluation, Vector& theta,
              ceres::Problem& problem) {
  const int n = static_cast<int>(theta.size());
  for (int i = 0; i < evaluation.f.residuals(); ++i)
    problem.AddResidualBlock(new SharedBlock(shared, i, 1, i * n, {n}), nullptr, theta.data());
  if (const Bounds* bounds = evaluation.f.bounds())
    set_bounds(*bounds, 0, n, theta.data(), problem);
}

// Those that the pattern of a sparse J declares.
void add_blocks(const SharedBlocks& shared, Evaluation& evaluation, Vector& theta,
                ceres::Problem& problem, ceres::Solver::Options& options) {
  const SparsePattern& pattern = *evaluation.f.sparse_pattern();
  const auto at = [&](int block) {
    return theta.data() + pattern.parameter_block[static_cast<std::size_t>(block)];
  };
  std::vector<int> sizes;
  std::vector<double*> places;
  for (int i = 0; i < pattern.residual_blocks(); ++i) {
    sizes.clear();
    places.clear();
    pattern.for_each_block(i, [&](int parameter, int) {
      sizes.push_back(pattern.size_of(parameter));
      places.push_back(at(parameter));
    });
    const int row = pattern.residual_block[static_cast<std::size_t>(i)];
    const int rows = pattern.residual_block[static_cast<std::size_t>(i) + 1] - row;
    const int value = pattern.row_start[static_cast<std::size_t>(row)];
    problem.AddResidualBlock(new SharedBlock(shared, row, rows, value, sizes), nullptr, places);
  }
  if (const Bounds* bounds = evaluation.f.bounds())
    for (int j = 0; j < pattern.parameter_blocks(); ++j)
      if (problem.HasParameterBlock(at(j)))
        set_bounds(*bounds, at(j) - theta.data(), pattern.size_of(j), at(j), problem);
  if (!pattern.has_eliminated()) return;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (int j = 0; j < pattern.parameter_blocks(); ++j)
    if (problem.HasParameterBlock(at(j)))
      options.linear_solver_ordering->AddElementToGroup(at(j), j < pattern.first_eliminated);
}

Status solve(ceres::Solver::Options options, Evaluation& evaluation, Vector& theta) {
  SharedBlocks shared(evaluation, theta);
  ceres::Problem::Options calls;
  calls.evaluation_callback = &shared;
  ceres::Problem problem(calls);  // owns the blocks
  if (evaluation.f.is_sparse()) {
    add_blocks(shared, evaluation, theta, problem, options);
  } else {
    add_rows(shared, evaluation, theta, problem);
  }
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
  explicit Ceres(Options options, std::string linear_solver = "")
      : options_(std::move(options)), linear_solver_(std::move(linear_solver)) {}
  void start(Meter&, const Vector&) override {}
  bool reports_iterations() const override { return true; }
  Status step(Meter& f, Vector& theta) override {
    Evaluation evaluation{f, theta};
    Watch watch(f, theta);
    Options options = options_;
    set_common(options, watch);
    if constexpr (requires { options.linear_solver_type; })
      for (const auto& [name, type] : kSparseSolvers)
        if (linear_solver_of(linear_solver_, f.is_sparse() ? f.sparse_pattern() : nullptr) == name)
          options.linear_solver_type = type;
    const Status status = solve(options, evaluation, theta);
    if (status == Status::budget)
      theta = watch.last;  // Ceres goes back to the start if a call failed
    return status;
  }

 private:
  const Options options_;
  const std::string linear_solver_;
};

// The options of every method here: its own, then the tolerances.
OptionTable with_tolerances(OptionTable own) {
  const std::pair<const char*, const char*> tolerances[] = {
      {"function-tolerance", "it stops where the loss changes by no more than this share"},
      {"gradient-tolerance", "it stops where no component of the gradient is larger"},
      {"parameter-tolerance", "it stops where the step is no longer than this share of ‖θ‖"}};
  for (const auto& [name, text] : tolerances)
    own.push_back({name, Real{0}, between(0, 1), {}, text});
  return own;
}

template <class Options>
void set_tolerances(const OptionValues& options, Options& out) {
  out.function_tolerance = options.number("function-tolerance", 0);
  out.gradient_tolerance = options.number("gradient-tolerance", 0);
  out.parameter_tolerance = options.number("parameter-tolerance", 0);
}

constexpr const char* kRadiusNote = "Invariant while its Gauss-Newton steps lie within the radius.";
constexpr const char* kRejectsNote = "Steps that raise the loss are still rejected, then damped.";
// Measured: 1.3 % above the least loss on burgers[N=16,bounds=active].
constexpr const char* kBoundsNote =
    "On a problem with bounds, Ceres projects each step. Its model counts what the bounds cut off, "
    "so the radius shrinks, and the method can end short of a solution on a bound. It computes J at "
    "each trial point then, so bounds that never bind cost up to 3.4 times the Jacobians. ";
constexpr const char* kFailureNote =
    "Where an evaluation fails, Ceres gets no number, and tries a shorter step.";

struct TrustRegion {
  ceres::TrustRegionStrategyType strategy;
  ceres::DoglegType dogleg;
  const char *name, *title, *formula, *source;
  const char* note = "";
  bool is_input_scale_invariant = false, is_wide_open = false;
};

const TrustRegion kTrustRegions[] = {
    {ceres::LEVENBERG_MARQUARDT, ceres::TRADITIONAL_DOGLEG, "ceres-gauss-newton",
     "Gauss-Newton, safeguarded (Ceres)", "θ ← θ − J⁺ (y − y*)",
     "Ceres 2.1, Levenberg-Marquardt from the trust radius 1e16", kRejectsNote, true, true},
    {ceres::LEVENBERG_MARQUARDT, ceres::TRADITIONAL_DOGLEG, "ceres-lm",
     "Levenberg-Marquardt (Ceres)", "θ ← θ − (JᵀJ + D²/Δ)⁻¹ Jᵀ r,  D² = diag(JᵀJ)",
     "Ceres 2.1; Marquardt (1963), Nielsen (1999)"},
    {ceres::DOGLEG, ceres::TRADITIONAL_DOGLEG, "ceres-dogleg", "Powell's dogleg (Ceres)",
     "min ‖r + J d‖² along the path to steepest descent, then to Gauss-Newton",
     "Ceres 2.1; Powell (1970)", kRadiusNote, true},
    {ceres::DOGLEG, ceres::SUBSPACE_DOGLEG, "ceres-subspace-dogleg", "Subspace dogleg (Ceres)",
     "min ‖r + J d‖² over the plane of steepest descent and Gauss-Newton, ‖D d‖ ≤ Δ",
     "Ceres 2.1; Byrd, Schnabel, Shultz (1988)", kRadiusNote, true},
};

OptionField radius_field() {
  const ceres::Solver::Options standard;
  return {"radius",
          Real{standard.initial_trust_region_radius},
          {.low = 0, .high = standard.max_trust_region_radius, .low_is_open = true},
          {},
          "initial trust-region radius Δ, in units of D"};
}

OptionField linear_solver_field() {
  OptionField field{"linear-solver",
                    std::string(),
                    {},
                    {"", "dense-qr"},
                    "of each step: of a dense or a sparse J, or after elimination of blocks where "
                    "the problem declares them; none: dense QR, and where J is sparse and has 256 "
                    "unknowns or more as the problem declares it"};
  for (const auto& [name, type] : kSparseSolvers) field.choices.emplace_back(name);
  return field;
}

OracleSet needs_of_trust_region(const OptionValues& options, const Problem& problem) {
  const SparsePattern* sparse = is_solved_sparse(problem) ? problem.sparse_pattern() : nullptr;
  const bool is_dense = linear_solver_of(options.text("linear-solver"), sparse) == "dense-qr";
  return {Oracle::forward, is_dense ? Oracle::jacobian : Oracle::sparse_jacobian};
}

auto objection_of(const TrustRegion& m) {
  return [m](const OptionValues& options, const Problem& problem) -> std::string {
    const std::string solver = options.text("linear-solver");
    if (solver.ends_with("-schur") && !problem.sparse_pattern()->has_eliminated())
      return "linear-solver=" + solver + " eliminates blocks, and the problem declares none";
    if (solver == "iterative-schur" && m.strategy == ceres::DOGLEG)
      return "Ceres has no dogleg with linear-solver=iterative-schur";
    return "";
  };
}

OptimizerEntry entry_of(const TrustRegion& m) {
  OptionTable table{linear_solver_field()};
  if (!m.is_wide_open) table.push_back(radius_field());
  return {.name = m.name,
          .title = m.title,
          .family = Family::ceres,
          .kind = Kind::least_squares,
          .formula = m.formula,
          .source = m.source,
          .note = m.note + std::string(*m.note ? " " : "") + kBoundsNote + kFailureNote,
          .needs = {Oracle::forward, Oracle::jacobian},
          .is_input_scale_invariant = m.is_input_scale_invariant,
          .needs_same_samples = true,
          .keeps_bounds = true,
          .most_unknowns = 4096,
          .most_rank = 2048,  // dense QR
          .options = with_tolerances(std::move(table)),
          .tunable = m.is_wide_open ? Tunable{} : Tunable{.option = "radius", .factor = 10},
          .needs_for = needs_of_trust_region,
          .objection = objection_of(m),
          .make = [m](const OptionValues& options, const OptimizerRegistry&) {
            ceres::Solver::Options o;
            o.linear_solver_type = ceres::DENSE_QR;
#ifdef ISOLINE_PORTABLE
            // The Eigen inside Ceres blocks its products by the cache sizes that it reads from the
            // processor, which we cannot fix. LAPACK, from our OpenBLAS, depends on its kernel
            // only.
            o.dense_linear_algebra_library_type = ceres::LAPACK;
#endif
            o.trust_region_strategy_type = m.strategy;
            o.dogleg_type = m.dogleg;
            o.initial_trust_region_radius =
                m.is_wide_open ? o.max_trust_region_radius
                               : options.number("radius", o.initial_trust_region_radius);
            if (m.is_wide_open) o.min_relative_decrease = 0;
            set_tolerances(options, o);
            return std::make_unique<Ceres<ceres::Solver::Options>>(o,
                                                                   options.text("linear-solver"));
          }};
}

struct LineSearch {
  ceres::LineSearchDirectionType direction;
  Kind kind;
  const char *name, *title, *formula, *source;
  Index most_unknowns = std::numeric_limits<Index>::max();
};

const LineSearch kLineSearches[] = {
    {ceres::STEEPEST_DESCENT, Kind::gradient, "ceres-steepest-descent",
     "Steepest descent with line search (Ceres)", "θ ← θ − α ∇L,  α by the Wolfe conditions",
     "Ceres 2.1; Nocedal, Wright (2006), algorithm 3.5"},
    {ceres::NONLINEAR_CONJUGATE_GRADIENT, Kind::gradient, "ceres-ncg",
     "Nonlinear conjugate gradients (Ceres)", "d ← −∇L + β d,  β = ‖∇L‖²/‖∇L₋‖²,  θ ← θ + α d",
     "Ceres 2.1; Fletcher, Reeves (1964)"},
    {ceres::BFGS, Kind::quasi_newton, "ceres-bfgs", "BFGS (Ceres)",
     "θ ← θ − α B ∇L,  B ≈ H⁻¹ by rank-two updates, dense",
     "Ceres 2.1; Nocedal, Wright (2006), algorithm 6.1", 2048},
    {ceres::LBFGS, Kind::quasi_newton, "ceres-lbfgs", "Limited-memory BFGS (Ceres)",
     "θ ← θ − α B ∇L,  B ≈ H⁻¹ from the last 20 steps", "Ceres 2.1; Nocedal (1980)"},
};

// Between the constant of sufficient decrease and 1, as Ceres requires.
OptionField curvature_field() {
  const ceres::GradientProblemSolver::Options standard;
  return {"curvature",
          Real{standard.line_search_sufficient_curvature_decrease},
          {.low = standard.line_search_sufficient_function_decrease,
           .high = 1,
           .low_is_open = true,
           .high_is_open = true},
          {},
          "c₂ of the Wolfe conditions: largest share of the slope left along a line"};
}

OptimizerEntry entry_of(const LineSearch& method) {
  return {.name = method.name,
          .title = method.title,
          .family = Family::ceres,
          .kind = method.kind,
          .formula = method.formula,
          .source = method.source,
          .note = kFailureNote,
          .needs = {Oracle::forward, Oracle::pullback},
          .needs_same_samples = true,
          .most_unknowns = method.most_unknowns,
          .options = with_tolerances({curvature_field()}),
          .tunable = {.option = "curvature", .below = 6, .factor = 1.5},
          .make = [direction = method.direction](const OptionValues& options,
                                                 const OptimizerRegistry&) {
            ceres::GradientProblemSolver::Options o;
            o.line_search_direction_type = direction;
            o.line_search_sufficient_curvature_decrease =
                options.number("curvature", o.line_search_sufficient_curvature_decrease);
            set_tolerances(options, o);
            return std::make_unique<Ceres<ceres::GradientProblemSolver::Options>>(o);
          }};
}

}  // namespace

void register_ceres(OptimizerRegistry& registry) {
  for (const TrustRegion& method : kTrustRegions) registry.add(entry_of(method));
  for (const LineSearch& method : kLineSearches) registry.add(entry_of(method));
}

}  // namespace isoline::optimizers
