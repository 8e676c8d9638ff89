// Scale-invariant physics training, Holl, Koltun, Thuerey (2022), algorithm 1: pull the target back
// through the physics by its local inverse, x̃ = P⁻¹(y + Δy; x) with Δy = η (y* − y), then take a
// step of the network's optimizer on (1/B) Σ ½‖x − x̃‖², x̃ held. With the identity network and unit
// rates it is x ← x̃, the inverse-simulator update. Several steps of the inversion may be taken for
// one of the network, each from the x̃ of the last, and several of the network for one x̃ (theorem
// 3).
#include <fmt/format.h>

#include "optimizers/inversion.h"
#include "optimizers/network_descent.h"

namespace isoline::optimizers {
namespace {

struct Options {
  Real step = 1, max_loss_change = 0.2;
  std::string inverse = "auto", network_optimizer = "auto", proxy = "l2";
  Index inverse_evaluations = 200, inner_steps = 1, network_steps = 1;
};

void fields(Options& o, auto& field) {
  field("step", o.step, above(0), "step length η toward y*");
  field("inverse", o.inverse, Choices{"auto", "analytic", "damped", "newton", "lbfgs"},
        "local inverse: the problem's own, which damped asks to be a damped one; a saddle-free "
        "Newton step; or L-BFGS; auto: the problem's own where there is one, else L-BFGS");
  field("network-optimizer", o.network_optimizer, Choices{}, NetworkDescent::kDoc);
  field("proxy", o.proxy, Choices{"l2", "l1"}, "proxy loss: ½‖x − x̃‖² or Σ|x − x̃|");
  field("inner-steps", o.inner_steps, between(1, 1e6), "steps of the inversion an update");
  field("network-steps", o.network_steps, between(1, 1e6), "steps of the network toward each x̃");
  field("max-loss-change", o.max_loss_change, above(0),
        "of inverse=newton: limit Δ on the linear change of a sample's loss along a direction of "
        "low or negative curvature");
  field("inverse-evaluations", o.inverse_evaluations, between(1, 1e6),
        "of inverse=lbfgs: most evaluations in a step");
}

bool uses_own_inverse(const Options& o, Inverse kind) {
  if (o.inverse == "auto") return kind != Inverse::none;
  return o.inverse == "analytic" || o.inverse == "damped";
}

std::unique_ptr<Inversion> make_inversion(const Options& o, Inverse kind) {
  if (uses_own_inverse(o, kind)) return inversion_by_problem(o.step);
  if (o.inverse == "newton") return inversion_by_newton(o.step, o.max_loss_change);
  return inversion_by_lbfgs(o.step, o.inverse_evaluations);
}

class Sip final : public Optimizer {
 public:
  Sip(const Options& options, const OptimizerRegistry& registry)
      : options_(options), descent_(registry, options.network_optimizer) {}

  void start(Meter& f, const Vector&) override {
    inversion_ = make_inversion(options_, f.inverse_kind());
    descent_.start(f);
  }

  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    inversion_->invert(f, at_, found_);
    for (Index i = 1; i < options_.inner_steps && !f.is_spent(); ++i) {
      f.linearize_physics(found_, inner_);
      inversion_->invert(f, inner_, found_);
    }
    const Proxy proxy = options_.proxy == "l1" ? Proxy::l1 : Proxy::l2;
    descent_.approach(found_, proxy, at_, theta);
    for (Index i = 1; i < options_.network_steps && !f.is_spent(); ++i) {
      f.linearize(theta, at_);
      descent_.approach(found_, proxy, at_, theta);
    }
    return Status::running;
  }

  bool persist(Archive& archive) override { return descent_.persist(archive); }

 private:
  const Options options_;
  std::unique_ptr<Inversion> inversion_;
  NetworkDescent descent_;
  Linearization at_, inner_;
  Matrix found_;  // (k, B) x̃
};

OracleSet needs_for(const OptionValues& given, const Problem& problem) {
  const auto options = read_options<Options>(given);
  OracleSet needs{Oracle::forward, Oracle::network};
  if (uses_own_inverse(options, problem.inverse_kind())) {
    needs.add(Oracle::inverse);
  } else if (options.inverse == "newton") {
    needs.add(Oracle::sensitivity);
    needs.add(Oracle::curvature);
  } else {
    needs.add(Oracle::pullback);
  }
  return needs;
}

std::string objection(const OptionValues& given, const Problem& problem) {
  constexpr Index kMostInputs = 8;
  const std::string inverse = read_options<Options>(given).inverse;
  if (inverse == "damped" && problem.inverse_kind() != Inverse::damped)
    return "inverse=damped, and the physics has an inverse, but not a damped one";
  if (inverse == "newton" && problem.inputs() > kMostInputs)
    return fmt::format("inverse=newton is for up to {} inputs of the physics, which has {}",
                       kMostInputs, problem.inputs());
  return "";
}

}  // namespace

void register_sip(OptimizerRegistry& registry) {
  registry.add({.name = "sip",
                .title = "Scale-invariant physics",
                .family = Family::inversion,
                .formula = "x̃ = P⁻¹(y + η (y* − y); x);  θ ← one step on (1/B) Σ ½‖x − x̃‖²",
                .source = "Holl, Koltun, Thuerey (2022), algorithm 1",
                .note =
                    "The inverse is the problem's own, a saddle-free Newton step with exact second "
                    "derivatives, or found by L-BFGS; where it is damped or an estimate, x̃ = x + "
                    "η (P⁻¹(y*; x) − x), and for Newton x + η U. The problem's own inverse and its "
                    "second derivatives are privileges; L-BFGS is not.",
                .needs = {Oracle::forward, Oracle::network},
                .is_input_scale_invariant = true,
                .options = option_table<Options>(),
                .tunable = {.option = "step", .below = 5},
                .needs_for = needs_for,
                .inside = NetworkDescent::inside,
                .objection = objection,
                .make = [](const OptionValues& options,
                           const OptimizerRegistry& known) -> std::unique_ptr<Optimizer> {
                  return std::make_unique<Sip>(read_options<Options>(options), known);
                }});
}

}  // namespace isoline::optimizers
