// The adapter to libdogleg (Kogan, Oblong Industries): Powell's dogleg on r = (y − y*)/√B, with
// Cholesky of JᵀJ by LAPACK or, for a sparse J, by CHOLMOD. It requests J at each trial; J is
// computed only where ‖r‖ is smaller than before, since libdogleg rejects the other trials. It
// scales no unknown. By default it stops where rounding hides any further decrease.
#include <suitesparse/cholmod.h>

extern "C" {
#include <dogleg.h>
}

#include <algorithm>
#include <limits>
#include <memory>

#include "optimizers/optimizer.h"
#include "optimizers/residual_calls.h"

namespace isoline::optimizers {
namespace {

struct DoglegOptions {
  Real radius = 1e3, gradient_tolerance = 0, step_tolerance = 0, radius_tolerance = 1e-18;
};
void fields(DoglegOptions& o, auto& field) {
  field("radius", o.radius, above(0), "initial trust-region radius, of ‖d‖");
  field("gradient-tolerance", o.gradient_tolerance, at_least(0),
        "it stops where each component of Jᵀr is smaller");
  field("step-tolerance", o.step_tolerance, at_least(0),
        "it stops where each component of a step is smaller");
  field("radius-tolerance", o.radius_tolerance, at_least(0),
        "it stops where the radius is smaller");
}

// A search; libdogleg has no way to be stopped. A run that is over returns r = 0 and J = 0, where
// it stops by its own test.
struct Search {
  ResidualCalls& calls;
  const SparsePattern* pattern;  // none: J is dense
  Index m, n;
  Real least = std::numeric_limits<Real>::infinity();  // ‖r‖² of the last iterate

  // `J`: the values by rows
  void evaluate(const double* theta, double* r, double* J) {
    const Index values = pattern ? pattern->values() : m * n;
    std::fill_n(J, values, 0.0);
    if (!calls.residual(theta, r)) return stop(r);
    const Real squares = Eigen::Map<const Vector>(r, m).squaredNorm();
    if (!(squares < least)) return;
    least = squares;
    const bool is_running =
        pattern ? calls.sparse_jacobian(
                      theta, [&](const Vector& known) { std::copy_n(known.data(), values, J); })
                : calls.jacobian(theta, [&](const Vector&, const Matrix& known) {
                    Eigen::Map<Matrix>(J, n, m) = known.transpose();
                  });
    if (!is_running) stop(r);
  }
  void stop(double* r) const { std::fill_n(r, m, 0.0); }
};

void dense_call(const double* theta, double* r, double* J, void* search) {
  static_cast<Search*>(search)->evaluate(theta, r, J);
}
void sparse_call(const double* theta, double* r, cholmod_sparse* Jt, void* search) {
  Search& s = *static_cast<Search*>(search);
  std::ranges::copy(s.pattern->row_start, static_cast<int*>(Jt->p));
  std::ranges::copy(s.pattern->column, static_cast<int*>(Jt->i));
  s.evaluate(theta, r, static_cast<double*>(Jt->x));
}

class Dogleg final : public Optimizer {
 public:
  explicit Dogleg(const DoglegOptions& options) : options_(options) {}
  void start(Meter&, const Vector&) override {}
  bool reports_iterations() const override { return true; }
  Status step(Meter& f, Vector& theta) override {
    constexpr Real kNever = std::numeric_limits<Real>::min();  // its tests are strict
    dogleg_parameters2_t o;
    dogleg_getDefaultParameters(&o);
    o.max_iterations = std::numeric_limits<int>::max();
    o.trustregion0 = options_.radius;
    o.Jt_x_threshold = std::max(options_.gradient_tolerance, kNever);
    o.update_threshold = std::max(options_.step_tolerance, kNever);
    o.trustregion_threshold = std::max(options_.radius_tolerance, kNever);
    ResidualCalls calls(f, theta);
    Search search{calls, f.is_sparse() ? f.sparse_pattern() : nullptr, f.residuals(), theta.size()};
    const auto n = static_cast<unsigned>(search.n), m = static_cast<unsigned>(search.m);
    const double end =
        search.pattern
            ? dogleg_optimize2(theta.data(), n, m, static_cast<unsigned>(search.pattern->values()),
                               &sparse_call, &search, &o, nullptr)
            : dogleg_optimize_dense2(theta.data(), n, m, &dense_call, &search, &o, nullptr);
    return calls.end(theta, end < 0 ? "failed" : "returned",
                     end < 0 ? Status::stalled : Status::converged);
  }

 private:
  const DoglegOptions options_;
};

}  // namespace

void register_libdogleg(OptimizerRegistry& registry) {
  registry.add({.name = "libdogleg",
                .title = "Dogleg on the normal equations (libdogleg)",
                .family = Family::libdogleg,
                .kind = Kind::least_squares,
                .formula = "θ ← θ + d,  d on the path from −α Jᵀr to −(JᵀJ)⁻¹ Jᵀr,  ‖d‖ ≤ Δ",
                .source = "libdogleg 0.15; Powell (1970)",
                .note = kFailedNote,
                .needs = {Oracle::forward, Oracle::jacobian},
                .needs_same_samples = true,
                .most_unknowns = 4096,
                .most_rank = 2048,
                .options = option_table<DoglegOptions>(),
                .tunable = {.option = "radius", .factor = 10},
                .in_all = false,  // a peer for certified data, without tuned values of its option
                .needs_for = [](const OptionValues&, const Problem& problem) -> OracleSet {
                  return {Oracle::forward,
                          is_solved_sparse(problem) ? Oracle::sparse_jacobian : Oracle::jacobian};
                },
                .objection = too_few_residuals,
                .make =
                    [](const OptionValues& options, const OptimizerRegistry&) {
                      return std::make_unique<Dogleg>(read_options<DoglegOptions>(options));
                    }});
}

}  // namespace isoline::optimizers
