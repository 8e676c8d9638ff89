// Scale-invariant physics training, Holl, Koltun, Thuerey (2022), algorithm 1: pull the target back
// through the physics by its local inverse, x̃ = P⁻¹(y + Δy; x) with Δy = η (y* − y), then take one
// step of the network's optimizer on (1/B) Σ ½‖x − x̃‖², x̃ held. With the identity network and unit
// rates it is x ← x̃, the inverse-simulator update. A damped or estimated inverse does not undo P,
// so the step is taken in x: x̃ = x + η (P⁻¹(y*; x) − x). A sample whose inverse fails keeps its x,
// and so teaches nothing in this step.
#include <nlohmann/json.hpp>

#include "optimizers/lbfgs.h"
#include "optimizers/optimizer.h"

namespace isoline {
namespace {

struct Options {
  Real step = 1;
  std::string inverse = "auto", network_optimizer = "auto", proxy = "l2";
  Index inverse_evaluations = 200;
};

void fields(Options& o, auto& field) {
  field("step", o.step, above(0), "step length η toward y*");
  field("inverse", o.inverse, Choices{"auto", "analytic", "lbfgs"},
        "local inverse: the problem's own, or numerical; auto: the former where there is one");
  field("network-optimizer", o.network_optimizer, Choices{},
        "gradient rule on the proxy loss; auto: gd[rate=1] for the identity network, else "
        "adam[rate=1e-3]");
  field("proxy", o.proxy, Choices{"l2", "l1"}, "proxy loss: ½‖x − x̃‖² or Σ|x − x̃|");
  field("inverse-evaluations", o.inverse_evaluations, between(1, 1e6),
        "most evaluations of the numerical inversion in a step");
}

bool is_analytic(const Options& options, Inverse kind) {
  return options.inverse == "analytic" || (options.inverse == "auto" && kind != Inverse::none);
}

class Sip final : public Optimizer {
 public:
  Sip(const Options& options, const OptimizerRegistry& registry)
      : options_(options), registry_(registry) {
    if (options.network_optimizer != "auto")
      descent_ = make_descent(registry, options.network_optimizer);
  }

  void start(Meter& f, const Vector& theta) override {
    if (options_.network_optimizer == "auto")
      descent_ =
          make_descent(registry_, f.has_identity_network() ? "gd[rate=1]" : "adam[rate=1e-3]");
    descent_->start(theta.size());
    gradient_.resize(theta.size());
  }

  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    found_ = at_.x();
    if (is_analytic(options_, f.inverse_kind()))
      invert_by_problem(f);
    else
      invert_by_descent(f);
    pull_ = at_.x() - found_;
    if (options_.proxy == "l1") pull_ = pull_.cwiseSign();
    pull_ /= static_cast<Real>(f.samples());
    at_.network_pullback(pull_, gradient_);
    descent_->update(gradient_, theta);
    return Status::running;
  }

 private:
  void invert_by_problem(Meter& f) {
    const bool undoes_physics = f.inverse_kind() == Inverse::exact;
    wanted_ = f.target();
    if (undoes_physics) wanted_ = at_.y() + options_.step * (f.target() - at_.y());
    const Success success = at_.local_inverse(wanted_, found_);
    if (!undoes_physics) found_ = at_.x() + options_.step * (found_ - at_.x());
    for (Index b = 0; b < success.size(); ++b)
      if (!success[b]) found_.col(b) = at_.x().col(b);
  }

  // min ½‖P(x) − ỹ‖² from the current x, all samples at once, to the rounding of ỹ.
  void invert_by_descent(Meter& f) {
    constexpr Real kRelativeMisfit = 1e-14;
    wanted_ = at_.y() + options_.step * (f.target() - at_.y());
    const Index k = found_.rows(), samples = found_.cols();
    flat_ = found_.reshaped();
    const auto misfit = [&](VectorRef x, VectorOut gradient) {
      f.linearize_physics(Eigen::Map<const Matrix>(x.data(), k, samples), trial_);
      misfit_ = trial_.y() - wanted_;
      trial_.physics_pullback(misfit_, Eigen::Map<Matrix>(gradient.data(), k, samples));
      return 0.5 * misfit_.squaredNorm();
    };
    minimize_lbfgs(misfit,
                   {.evaluations = options_.inverse_evaluations,
                    .enough = 0.5 * kRelativeMisfit * kRelativeMisfit * wanted_.squaredNorm(),
                    .is_over = [&] { return f.is_spent(); }},
                   flat_);
    found_ = flat_.reshaped(k, samples);
  }

  const Options options_;
  const OptimizerRegistry& registry_;
  std::unique_ptr<Descent> descent_;
  Linearization at_, trial_;
  Matrix wanted_, misfit_;  // (m, B) ỹ, and P(x) − ỹ during descent
  Matrix found_, pull_;     // (k, B) x̃ and the proxy's gradient in x
  Vector flat_;             // (k·B) x̃ during descent
  Vector gradient_;         // (n)
};

OracleSet needs_for(const Json& options, const Problem& problem) {
  OracleSet needs{Oracle::forward, Oracle::network};
  needs.add(is_analytic(read_options<Options>(options), problem.inverse_kind()) ? Oracle::inverse
                                                                                : Oracle::pullback);
  return needs;
}

}  // namespace

void register_sip(OptimizerRegistry& registry) {
  registry.add({.name = "sip",
                .title = "Scale-invariant physics",
                .family = Family::inversion,
                .formula = "x̃ = P⁻¹(y + η (y* − y); x);  θ ← one step on (1/B) Σ ½‖x − x̃‖²",
                .source = "Holl, Koltun, Thuerey (2022), algorithm 1",
                .note =
                    "The inverse is the problem's own or found by L-BFGS; where it is damped or "
                    "an estimate, x̃ = x + η (P⁻¹(y*; x) − x). The problem's own inverse is a "
                    "privilege; the numerical one is not.",
                .needs = {Oracle::forward, Oracle::network},
                .is_input_scale_invariant = true,
                .options = option_table<Options>(),
                .revision = 2,
                .needs_for = needs_for,
                .make = [](const Json& options,
                           const OptimizerRegistry& known) -> std::unique_ptr<Optimizer> {
                  return std::make_unique<Sip>(read_options<Options>(options), known);
                }});
}

}  // namespace isoline
