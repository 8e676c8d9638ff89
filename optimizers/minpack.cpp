// The adapter to MINPACK (Moré, Garbow, Hillstrom 1980; the C translation cminpack), on r = (y −
// y*)/√B: lmder, with exact Jacobians, and lmdif, with forward differences. MINPACK keeps its own
// loop; a step that it accepts is an iteration. By default its tolerances are zero: it stops where
// rounding hides any further decrease.
#include <cminpack.h>

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "optimizers/optimizer.h"
#include "optimizers/residual_calls.h"

namespace isoline::optimizers {
namespace {

struct MinpackOptions {
  Real ftol = 0, xtol = 0, gtol = 0;
  Real factor = 100;
};
void fields(MinpackOptions& o, auto& field) {
  field("ftol", o.ftol, at_least(0), "relative decrease of ‖r‖² at which it stops");
  field("xtol", o.xtol, at_least(0), "relative length of a step at which it stops");
  field("gtol", o.gtol, at_least(0), "cosine between r and a column of J at which it stops");
  field("factor", o.factor, above(0), "initial step bound Δ, in units of ‖D θ‖");
}

struct LmdifOptions : MinpackOptions {
  Real epsfcn = 0;
};
void fields(LmdifOptions& o, auto& field) {
  fields(static_cast<MinpackOptions&>(o), field);
  field("epsfcn", o.epsfcn, at_least(0), "relative error of r; 0: that of rounding");
}

// MINPACK's requests; it stops at a negative answer.
constexpr int kResidual = 1, kStop = -1;

int answer(bool is_running) { return is_running ? 0 : kStop; }

int lmder_call(void* calls, int m, int n, const double* theta, double* r, double* J, int rows,
               int request) {
  ResidualCalls& f = *static_cast<ResidualCalls*>(calls);
  if (request == kResidual) return answer(f.residual(theta, r));
  return answer(f.jacobian(theta, [&](const Vector&, const Matrix& value) {
    Eigen::Map<Matrix, 0, Eigen::OuterStride<>>(J, m, n, Eigen::OuterStride<>(rows)) = value;
  }));
}

int lmdif_call(void* calls, int, int, const double* theta, double* r, int request) {
  ResidualCalls& f = *static_cast<ResidualCalls*>(calls);
  if (request == kResidual) return answer(f.residual(theta, r));
  return answer(f.accept() && f.evaluate(theta, r));
}

// MINPACK's arrays.
struct Work {
  int m, n;
  Matrix J = Matrix(m, n);
  Vector r = Vector(m), scale = Vector(n), qtf = Vector(n), wa1 = Vector(n), wa2 = Vector(n),
         wa3 = Vector(n), wa4 = Vector(m);
  std::vector<int> pivots = std::vector<int>(static_cast<std::size_t>(n));
};

constexpr int kNoLimit = std::numeric_limits<int>::max(), kScalesItself = 1, kPrintsNothing = 0;

int solve(const MinpackOptions& o, ResidualCalls& calls, Vector& theta, Work& w) {
  int residuals = 0, jacobians = 0;
  return lmder(&lmder_call, &calls, w.m, w.n, theta.data(), w.r.data(), w.J.data(), w.m, o.ftol,
               o.xtol, o.gtol, kNoLimit, w.scale.data(), kScalesItself, o.factor, kPrintsNothing,
               &residuals, &jacobians, w.pivots.data(), w.qtf.data(), w.wa1.data(), w.wa2.data(),
               w.wa3.data(), w.wa4.data());
}

int solve(const LmdifOptions& o, ResidualCalls& calls, Vector& theta, Work& w) {
  int residuals = 0;
  return lmdif(&lmdif_call, &calls, w.m, w.n, theta.data(), w.r.data(), o.ftol, o.xtol, o.gtol,
               kNoLimit, o.epsfcn, w.scale.data(), kScalesItself, o.factor, kPrintsNothing,
               &residuals, w.J.data(), w.m, w.pivots.data(), w.qtf.data(), w.wa1.data(),
               w.wa2.data(), w.wa3.data(), w.wa4.data());
}

// By the number that lmder and lmdif return.
constexpr const char* kEnds[] = {"improper input",
                                 "ftol",
                                 "xtol",
                                 "ftol and xtol",
                                 "gtol",
                                 "the limit of calls",
                                 "ftol is too small for a further decrease",
                                 "xtol is too small for a further step",
                                 "gtol is too small: r is orthogonal to the columns of J"};

template <class Options>
class Minpack final : public Optimizer {
 public:
  explicit Minpack(const Options& options) : options_(options) {}
  void start(Meter&, const Vector&) override {}
  bool reports_iterations() const override { return true; }
  Status step(Meter& f, Vector& theta) override {
    ResidualCalls calls(f, theta);
    Work work{static_cast<int>(f.residuals()), static_cast<int>(f.unknowns())};
    const int end = solve(options_, calls, theta, work);
    const bool is_own_test = end > 0 && std::cmp_less(end, std::size(kEnds));
    return calls.end(theta, is_own_test ? kEnds[end] : "stopped",
                     is_own_test ? Status::converged : Status::stalled);
  }

 private:
  const Options options_;
};

template <class Options>
OptimizerEntry minpack_entry(OptimizerEntry entry) {
  entry.family = Family::minpack;
  entry.kind = Kind::least_squares;
  entry.is_input_scale_invariant = true;
  entry.needs_same_samples = true;
  entry.in_all = false;    // a peer for certified data, without tuned values of its option
  entry.most_rank = 1024;  // its factorization has no blocks
  entry.options = option_table<Options>();
  entry.tunable = {.option = "factor", .below = 4, .factor = 10};
  entry.objection = too_few_residuals;
  entry.make = [](const OptionValues& options, const OptimizerRegistry&) {
    return std::make_unique<Minpack<Options>>(read_options<Options>(options));
  };
  return entry;
}

}  // namespace

void register_minpack(OptimizerRegistry& registry) {
  constexpr const char* kSource = "Moré (1978); MINPACK (1980), cminpack 1.3";
  registry.add(minpack_entry<MinpackOptions>(
      {.name = "minpack-lmder",
       .title = "Levenberg-Marquardt (MINPACK lmder)",
       .formula = "min ‖r + J d‖² over ‖D d‖ ≤ Δ,  Dᵢ the largest ‖J eᵢ‖ so far",
       .source = kSource,
       .note = kFailedNote,
       .needs = {Oracle::forward, Oracle::jacobian},
       .most_unknowns = 4096}));
  registry.add(minpack_entry<LmdifOptions>(
      {.name = "minpack-lmdif",
       .title = "Levenberg-Marquardt by differences (MINPACK lmdif)",
       .formula = "min ‖r + J d‖² over ‖D d‖ ≤ Δ,  J by forward differences",
       .source = kSource,
       .note = std::string("A Jacobian costs n forward solves. ") + kFailedNote,
       .needs = {Oracle::forward},
       .most_unknowns = 256}));
}

}  // namespace isoline::optimizers
