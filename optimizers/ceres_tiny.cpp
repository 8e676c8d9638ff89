// The adapter to Ceres' TinySolver, a Levenberg-Marquardt on the normal equations in one header, on
// r = (y − y*)/√B. Each evaluation is a trial step. TinySolver has no callback, so an exception
// ends it.
#include <ceres/tiny_solver.h>

#include <limits>
#include <memory>

#include "optimizers/optimizer.h"
#include "optimizers/residual_calls.h"

namespace isoline::optimizers {
namespace {

struct CeresTiny {
  Real radius = 1e4;
  Real function_tolerance = 0, gradient_tolerance = 0, parameter_tolerance = 1e-18;
  Real cost_threshold = 0;
};
void fields(CeresTiny& o, auto& field) {
  field("radius", o.radius, above(0), "initial trust-region radius Δ");
  field("function-tolerance", o.function_tolerance, at_least(0),
        "change of ‖r‖² at which it stops");
  field("gradient-tolerance", o.gradient_tolerance, at_least(0),
        "largest element of the scaled gradient at which it stops");
  field("parameter-tolerance", o.parameter_tolerance, above(0),
        "relative length of a step at which it stops");
  field("cost-threshold", o.cost_threshold, at_least(0), "½‖r‖² at which it stops");
}

struct Stopped {};

struct TinyFunction {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };
  ResidualCalls& calls;
  Index m, n;

  int NumResiduals() const { return static_cast<int>(m); }
  int NumParameters() const { return static_cast<int>(n); }
  bool operator()(const double* theta, double* r, double* J) const {
    // A singular system gives a θ that is not finite, at which TinySolver would stay.
    const bool is_evaluated =
        is_finite(Vector(Eigen::Map<const Vector>(theta, n))) &&
        (J == nullptr ? calls.residual(theta, r)
                      : calls.jacobian(theta, [&](const Vector& residual, const Matrix& value) {
                          Eigen::Map<Vector>(r, m) = residual;
                          Eigen::Map<Matrix>(J, m, n) = value;
                        }));
    if (!is_evaluated) throw Stopped();
    return true;
  }
};

class Tiny final : public Optimizer {
 public:
  explicit Tiny(const CeresTiny& options) : options_(options) {}
  void start(Meter&, const Vector&) override {}
  bool reports_iterations() const override { return true; }
  Status step(Meter& f, Vector& theta) override {
    using Solver = ceres::TinySolver<TinyFunction>;
    ResidualCalls calls(f, theta);
    Solver solver;
    solver.options.max_num_iterations = std::numeric_limits<int>::max();
    solver.options.function_tolerance = options_.function_tolerance;
    solver.options.gradient_tolerance = options_.gradient_tolerance;
    solver.options.parameter_tolerance = options_.parameter_tolerance;
    solver.options.cost_threshold = options_.cost_threshold;
    solver.options.initial_trust_region_radius = options_.radius;
    bool is_own_test = true;
    try {
      solver.Solve({calls, f.residuals(), f.unknowns()}, &theta);
    } catch (const Stopped&) {
      is_own_test = false;
    }
    constexpr const char* kEnds[] = {"gradient tolerance", "parameter tolerance", "cost threshold",
                                     "the limit of iterations", "function tolerance"};
    return calls.end(theta, is_own_test ? kEnds[solver.summary.status] : "stopped",
                     is_own_test ? Status::converged : Status::stalled);
  }

 private:
  const CeresTiny options_;
};

}  // namespace

void register_ceres_tiny(OptimizerRegistry& registry) {
  registry.add({.name = "ceres-tiny",
                .title = "Levenberg-Marquardt on the normal equations (Ceres TinySolver)",
                .family = Family::ceres,
                .kind = Kind::least_squares,
                .formula = "θ ← θ − (JᵀJ + D²/Δ)⁻¹ Jᵀ r,  D² = diag(JᵀJ)",
                .source = "Ceres 2.1, tiny_solver.h; Madsen, Nielsen, Tingleff (2004)",
                .note = kFailedNote,
                .needs = {Oracle::forward, Oracle::jacobian},
                .needs_same_samples = true,
                .most_unknowns = 1024,
                .options = option_table<CeresTiny>(),
                .tunable = {.option = "radius", .factor = 10},
                .in_all = false,  // a peer for certified data, without tuned values of its option
                .make = [](const OptionValues& options, const OptimizerRegistry&) {
                  return std::make_unique<Tiny>(read_options<CeresTiny>(options));
                }});
}

}  // namespace isoline::optimizers
