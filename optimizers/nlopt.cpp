// The adapter to NLopt (Johnson, github.com/stevengj/nlopt), on L. NLopt keeps its own loop; each
// new best evaluation is an iteration. Its tolerances are off, except for steps below the rounding
// of θ; a long search without a new best is stopped. NLopt reports success on plateaus; the record
// stores it. In NLopt 2.7 the scale of the loss, not an initial step, sets the first step along ∇L.
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <utility>

#include "optimizers/inversion.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

using Eigen::Map;
using Handle = std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)>;

constexpr Real kRounding = 1e-15;  // relative step below which θ no longer changes
constexpr Index kPatience = 100;   // evaluations an unknown without a new best
constexpr Real kWall = 1e20;       // replaces a loss that is not finite: infinity hangs COBYLA
// Steps that Luksan's methods remember. NLopt's own 10 MB take 7 ms at n = 2; ten cost digits.
constexpr Index kMemory = 100;

Handle make_handle(nlopt_algorithm algorithm, Index n, Index memory = kMemory) {
  Handle handle(nlopt_create(algorithm, static_cast<unsigned>(n)), &nlopt_destroy);
  nlopt_set_vector_storage(handle.get(), static_cast<unsigned>(memory));
  return handle;
}

// One evaluation for NLopt. No exception crosses NLopt; a loss that is not finite becomes a wall.
template <class Solve>
double evaluate(unsigned, const double* at, double* out, void* self) {
  Solve& solve = *static_cast<Solve*>(self);
  try {
    if (!solve.error && !solve.is_over()) {
      const Real loss = solve.evaluate(at, out);
      return std::isfinite(loss) ? loss : kWall;
    }
  } catch (const BudgetSpent&) {  // of a whole solve the meter knows from then on
    if (!Solve::kIsWhole) solve.error = std::current_exception();
  } catch (...) {
    solve.error = std::current_exception();
  }
  nlopt_force_stop(solve.handle);
  return kWall;
}

template <class Solve>
nlopt_result minimize(Solve& solve, Vector& theta) {
  nlopt_set_min_objective(solve.handle, &evaluate<Solve>, &solve);
  nlopt_set_xtol_rel(solve.handle, kRounding);
  Real loss = 0;
  const nlopt_result result = nlopt_optimize(solve.handle, theta.data(), &loss);
  if (solve.error) std::rethrow_exception(solve.error);
  return result;
}

// One solve, as seen from NLopt's calls back.
struct Search {
  static constexpr bool kIsWhole = true;
  Meter& f;
  nlopt_opt handle;
  Real loss_scale = 1;
  Linearization at;
  Vector theta, gradient, best;  // (n)
  Real best_loss = std::numeric_limits<Real>::infinity();
  Index since_best = 0;
  std::exception_ptr error;

  bool is_over() const { return f.is_spent() || f.status() != Status::running; }
  bool was_stopped() const {  // by us, whatever NLopt calls it
    return is_over() || since_best > kPatience * (theta.size() + 1);
  }
  Real evaluate(const double* at_theta, double* out) {
    theta = Map<const Vector>(at_theta, theta.size());  // aligned, whatever NLopt's array is
    // BOBYQA and COBYLA leave the bounds by rounding.
    if (const Bounds* bounds = f.bounds()) theta = bounds->nearest(theta);
    if (!out) return loss_scale * take(f.loss(theta));
    f.linearize(theta, at);
    at.gradient(gradient);
    if (!is_finite(gradient)) gradient.setZero();  // the evaluation failed
    Map<Vector>(out, gradient.size()) = loss_scale * gradient;
    return loss_scale * take(at.loss());
  }

  Real take(Real loss) {
    if (loss < best_loss) {
      const bool is_start = !std::isfinite(std::exchange(best_loss, loss));
      best = theta;
      since_best = 0;
      if (!is_start && f.iterate(best) != Status::running) nlopt_force_stop(handle);
    } else if (++since_best > kPatience * (theta.size() + 1)) {
      nlopt_force_stop(handle);
    }
    return loss;
  }
};

struct NloptOptions {
  Index memory = kMemory;
  Real loss_scale = 1;    // of methods with gradients
  Real initial_step = 1;  // of the others, in units of NLopt's choice
  Real first_step = 0;    // instead, in units of max(1, ‖θ₀‖∞)
};

void set_initial_step(nlopt_opt handle, const Vector& theta, Real multiple, Real first) {
  if (first > 0)
    nlopt_set_initial_step1(handle, first * std::max<Real>(1, theta.lpNorm<Eigen::Infinity>()));
  if (first > 0 || multiple == 1) return;
  Vector step(theta.size());
  nlopt_set_default_initial_step(handle, theta.data());
  nlopt_get_initial_step(handle, theta.data(), step.data());
  step *= multiple;
  nlopt_set_initial_step(handle, step.data());
}

// The first step stays what it is without bounds, unless a bound is nearer: a step of the distance
// to one would let a simplex fall onto it. As NLopt chooses its own.
void set_bounds(nlopt_opt handle, const Vector& theta, const Bounds& bounds) {
  constexpr Real kShareOfBox = 0.25, kShareOfWay = 0.75;
  Vector step(theta.size());
  nlopt_get_initial_step(handle, theta.data(), step.data());
  step = step.array().abs().min(kShareOfBox * (bounds.upper - bounds.lower).array());
  for (const Vector& way : {Vector(bounds.upper - theta), Vector(theta - bounds.lower)})
    step = (way.array() > 0).select(step.cwiseMin(kShareOfWay * way), step);
  step = (step.array() > 0).select(step, 1);  // of an unknown that is fixed
  nlopt_set_initial_step(handle, step.data());
  nlopt_set_lower_bounds(handle, bounds.lower.data());
  nlopt_set_upper_bounds(handle, bounds.upper.data());
}

class Nlopt final : public Optimizer {
 public:
  Nlopt(nlopt_algorithm algorithm, const NloptOptions& options)
      : algorithm_(algorithm), options_(options) {}
  void start(Meter&, const Vector&) override {}
  bool reports_iterations() const override { return true; }
  Status step(Meter& f, Vector& theta) override {
    const Handle handle = make_handle(algorithm_, theta.size(), options_.memory);
    set_initial_step(handle.get(), theta, options_.initial_step, options_.first_step);
    if (const Bounds* bounds = f.bounds()) set_bounds(handle.get(), theta, *bounds);
    const Real unit = f.residual_unit();
    Search search{
        f, handle.get(), options_.loss_scale * unit * unit, {}, theta, Vector(theta.size()), theta};
    const nlopt_result result = minimize(search, theta);
    f.claim(search.was_stopped() ? "stopped" : nlopt_result_to_string(result));
    theta = search.best;
    if (f.status() != Status::running) return f.status();
    if (f.is_spent()) return Status::budget;
    return result > 0 || result == NLOPT_ROUNDOFF_LIMITED ? Status::converged : Status::stalled;
  }

 private:
  nlopt_algorithm algorithm_;
  NloptOptions options_;
};

struct Method {
  nlopt_algorithm algorithm;
  Kind kind;
  const char *name, *title, *formula, *source;
  const char* note = "";
  bool is_input_scale_invariant = false;
  Index most_unknowns = std::numeric_limits<Index>::max();
  bool is_luksans() const {
    return algorithm == NLOPT_LD_LBFGS || algorithm == NLOPT_LD_VAR2 ||
           algorithm == NLOPT_LD_TNEWTON_PRECOND_RESTART;
  }
};

constexpr const char* kFailedLossNote =
    "Where an evaluation fails, NLopt is given a loss of 1e20 and a gradient of 0.";
constexpr const char* kFirstStepNote =
    "The first trial step is the full gradient; the method stops if that is far too long.";

const Method kByGradient[] = {
    {NLOPT_LD_LBFGS, Kind::quasi_newton, "nlopt-lbfgs", "Limited-memory BFGS (NLopt)",
     "θ ← θ − α B ∇L,  B ≈ H⁻¹ from the last steps", "NLopt 2.7, Luksan's PLIS; Nocedal (1980)",
     kFirstStepNote},
    {NLOPT_LD_VAR2, Kind::quasi_newton, "nlopt-var2",
     "Shifted limited-memory variable metric (NLopt)",
     "θ ← θ − α (μI + S) ∇L,  S of rank two per step",
     "NLopt 2.7, Luksan's PLIP; Vlcek, Luksan (2006)", kFirstStepNote},
    {NLOPT_LD_TNEWTON_PRECOND_RESTART, Kind::second_order, "nlopt-tnewton",
     "Truncated Newton, preconditioned, restarted (NLopt)",
     "H d ≈ −∇L by conjugate gradients, H d by differences of ∇L,  θ ← θ + α d",
     "NLopt 2.7, Luksan's PNET; Dembo, Steihaug (1983)", kFirstStepNote},
    {NLOPT_LD_SLSQP, Kind::quasi_newton, "nlopt-slsqp",
     "Sequential least-squares programming (NLopt)", "min ∇Lᵀd + ½ dᵀB d,  θ ← θ + α d",
     "NLopt 2.7; Kraft (1994)",
     "Dense, O(n³) per step; does not check the clock between evaluations.", false, 1000},
    {NLOPT_LD_MMA, Kind::gradient, "nlopt-mma", "Method of moving asymptotes (NLopt)",
     "min of a convex separable upper approximation of L", "NLopt 2.7; Svanberg (2002)"},
    {NLOPT_LD_CCSAQ, Kind::gradient, "nlopt-ccsaq",
     "Conservative convex separable approximation (NLopt)",
     "min L + ∇Lᵀd + ½ρ Σ (dᵢ/σᵢ)²,  ρ raised until conservative", "NLopt 2.7; Svanberg (2002)"},
};

constexpr Index kMostWithoutGradient = 256;
constexpr const char* kStartNote =
    "Its first steps have the size of the coordinates of the start, so they scale with the units.";

const Method kWithoutGradient[] = {
    {NLOPT_LN_BOBYQA, Kind::derivative_free, "nlopt-bobyqa", "BOBYQA (NLopt)",
     "min of a quadratic through 2n+1 points, ‖d‖ ≤ Δ", "NLopt 2.7; Powell (2009)", kStartNote,
     true},
    {NLOPT_LN_COBYLA, Kind::derivative_free, "nlopt-cobyla", "COBYLA (NLopt)",
     "min of a linear model through n+1 points, ‖d‖ ≤ Δ", "NLopt 2.7; Powell (1994)"},
    {NLOPT_LN_NELDERMEAD, Kind::derivative_free, "nlopt-neldermead", "Nelder-Mead simplex (NLopt)",
     "reflect, expand, contract or shrink n+1 points", "NLopt 2.7; Nelder, Mead (1965)", kStartNote,
     true},
    {NLOPT_LN_SBPLX, Kind::derivative_free, "nlopt-sbplx", "Subplex (NLopt)",
     "Nelder-Mead on a sequence of subspaces", "NLopt 2.7; Rowan (1990)"},
    {NLOPT_LN_NEWUOA, Kind::derivative_free, "nlopt-newuoa", "NEWUOA (NLopt)",
     "min of a quadratic through 2n+1 points, its Hessian of least change, ‖d‖ ≤ Δ",
     "NLopt 2.7; Powell (2006)"},
};

const OptionField kRemembered{
    "memory", kMemory, between(0, 1000), {}, "steps remembered; 0: as many as fit into 10 MB"};
const OptionField kLossScale{"loss-scale",
                             Real{1},
                             above(0),
                             {},
                             "factor of the loss as NLopt sees it, which sets the first step"};
const OptionField kInitialStep{
    "initial-step", Real{1}, above(0), {}, "first step, in units of the one that NLopt chooses"};

const OptionField kFirstStep{
    "first-step",
    Real{0},
    at_least(0),
    {},
    "first step of each unknown, in units of max(1, ‖θ₀‖∞); 0: initial-step"};

OptionTable options_of(const Method& m, Family family) {
  if (family == Family::nlopt_derivative_free) return {kInitialStep, kFirstStep};
  return m.is_luksans() ? OptionTable{kRemembered, kLossScale} : OptionTable{kLossScale};
}

std::string too_few_unknowns(const OptionValues&, const Problem& problem) {
  return problem.unknowns() < 2 ? "NEWUOA requires at least two unknowns" : "";
}

OptimizerEntry entry_of(const Method& m, Family family, OracleSet needs) {
  const bool is_newuoa = m.algorithm == NLOPT_LN_NEWUOA;
  return {.name = m.name,
          .title = m.title,
          .family = family,
          .kind = m.kind,
          .formula = m.formula,
          .source = m.source,
          .note = m.note + std::string(*m.note ? " " : "") + kFailedLossNote,
          .needs = needs,
          .is_input_scale_invariant = m.is_input_scale_invariant,
          .needs_same_samples = true,
          .keeps_bounds = !is_newuoa,
          .most_unknowns = family == Family::nlopt ? m.most_unknowns : kMostWithoutGradient,
          .options = options_of(m, family),
          .tunable = family == Family::nlopt ? Tunable{.option = "loss-scale", .below = 5}
                                             : Tunable{.option = "initial-step", .below = 4},
          .in_all = !is_newuoa,  // of the suite forward
          .objection = is_newuoa ? &too_few_unknowns : nullptr,
          .make = [algorithm = m.algorithm](const OptionValues& options, const OptimizerRegistry&) {
            return std::make_unique<Nlopt>(
                algorithm,
                NloptOptions{.memory = static_cast<Index>(options.number("memory", kMemory)),
                             .loss_scale = options.number("loss-scale", 1),
                             .initial_step = options.number("initial-step", 1),
                             .first_step = options.number("first-step", 0)});
          }};
}

// The arguments of minimize_lbfgs through NLopt. Luksan's first trial step, the full gradient, and
// his test ‖∇f‖ ≤ 1e-8 make sense in units of the start: f₀, and Polyak's step f₀/‖∇f₀‖ for
// lengths, which also keeps the first step on the branch of the start.
struct Minimization {
  static constexpr bool kIsWhole = false;  // part of a step
  const ValueAndGradient& f;
  const LbfgsLimits& limits;
  Vector origin, x, gradient, best;  // (n)
  nlopt_opt handle = nullptr;
  Real least = std::numeric_limits<Real>::infinity();
  Index evaluations = 0;
  Real unit = 0, length = 0;  // f₀, f₀/‖∇f₀‖; 0: not yet known
  std::exception_ptr error = nullptr;

  bool is_over() const {
    return least <= limits.enough || evaluations >= limits.evaluations ||
           (limits.is_over && limits.is_over());
  }

  Real evaluate(const double* z, double* out) {  // at x = origin + length z
    x = origin + length * Map<const Vector>(z, origin.size());
    ++evaluations;
    const Real value = f(x, gradient);
    if (value < least) best = x;
    least = std::min(least, value);
    if (length == 0) {
      unit = value;
      length = value / gradient.norm();
      if (!std::isfinite(length)) {
        nlopt_force_stop(handle);
        return kWall;
      }
    }
    if (out) Map<Vector>(out, gradient.size()) = (length / unit) * gradient;
    return value / unit;
  }

  void descend() {
    const Handle owned = make_handle(NLOPT_LD_LBFGS, origin.size());
    handle = owned.get();
    origin = best;
    length = 0;
    Vector z = Vector::Zero(origin.size());
    minimize(*this, z);  // its verdict adds nothing to the value reached
  }
};

}  // namespace

void minimize_lbfgs(const ValueAndGradient& f, const LbfgsLimits& limits, Vector& x) {
  constexpr Real kWorthwhile = 0.1;  // a descent in new units goes on while it gains this factor
  Minimization minimization{f, limits, x, x, Vector(x.size()), x};
  Real before = 0;
  do {
    before = minimization.least;
    minimization.descend();
  } while (!minimization.is_over() && minimization.least < kWorthwhile * before);
  x = minimization.best;
}

void register_nlopt(OptimizerRegistry& registry) {
  for (const Method& method : kByGradient)
    registry.add(entry_of(method, Family::nlopt, {Oracle::forward, Oracle::pullback}));
  for (const Method& method : kWithoutGradient)
    registry.add(entry_of(method, Family::nlopt_derivative_free, {Oracle::forward}));
}

}  // namespace isoline::optimizers
