// Scale-invariant physics training as theorem 3 of Holl, Koltun, Thuerey (2022) has it converge:
// with U = x̃ − x and L(x + U) = (1 − τ) L(x) the network takes steps toward x̃, held, until
//
//   L(N(θ)) ≤ (1 − τ/2) L(x),
//
// half of what U itself gives, and only then is the physics inverted again. At most `most-steps`,
// for a network need not be able to. The bound K of the theorem's second condition is measured as
// ‖U‖ ≤ K ‖y − y*‖. Deviation: all samples of a fresh batch are stopped together, by their mean
// loss.
#include <cmath>

#include "optimizers/inversion.h"
#include "optimizers/network_descent.h"

namespace isoline::optimizers {
namespace {

struct Options {
  InversionOptions inversion;
  std::string network_optimizer = "auto";
  Index most_steps = 100;
};

void fields(Options& o, auto& field) {
  fields(o.inversion, field);
  field("network-optimizer", o.network_optimizer, Choices{}, NetworkDescent::kDoc);
  field("most-steps", o.most_steps, between(1, 1e6), "steps of the network toward each x̃, at most");
}

class SipTheorem3 final : public ProxyMethod {
 public:
  SipTheorem3(const Options& options, const OptimizerRegistry& registry)
      : ProxyMethod(registry, options.network_optimizer), options_(options) {}

  void start(Meter& f, const Vector& theta) override {
    inversion_ = make_inversion(options_.inversion, f.inverse_kind());
    ProxyMethod::start(f, theta);
    f.name_series({"τ of U", "K of U", "length of U", "network steps of U"});
  }

  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    inversion_->invert(f, at_, found_);
    f.linearize_physics(found_, reached_);
    const Real tau = 1 - reached_.loss() / at_.loss();
    const Real goal = (1 - tau / 2) * at_.loss();
    const Real length = (found_ - at_.x()).norm();
    f.note(0, tau);
    f.note(1, length / (at_.y() - f.target()).norm());
    f.note(2, length / std::sqrt(static_cast<Real>(found_.cols())));
    Index steps = 0;
    do {
      descent_.approach(found_, Proxy::l2, at_, theta);
      f.linearize(theta, at_);
    } while (++steps < options_.most_steps && at_.loss() > goal && !f.is_spent());
    f.note(3, static_cast<Real>(steps));
    return Status::running;
  }

 private:
  const Options options_;
  std::unique_ptr<Inversion> inversion_;
  Linearization reached_;
};

}  // namespace

void register_sip_theorem_3(OptimizerRegistry& registry) {
  registry.add(proxy_entry<SipTheorem3, Options>(
      {.name = "sip-theorem-3",
       .title = "Scale-invariant physics, stopped by theorem 3",
       .formula = "x̃ = x + U;  θ ← steps on (1/B) Σ ½‖x − x̃‖² until L ≤ (1 − τ/2) L(x),  "
                  "τ = 1 − L(x + U)/L(x)",
       .source = "Holl, Koltun, Thuerey (2022), theorem 3",
       .note = "All samples of a batch stop together. The trace contains τ, K = ‖U‖/‖y − "
               "y*‖, the length of U as a root mean square over the samples, and the "
               "network's steps. Each check of the loss counts as a forward solve.",
       .needs = {Oracle::forward, Oracle::network},
       .is_input_scale_invariant = true,
       .tunable = {.option = "step", .below = 5},
       .in_all = false,
       .needs_for = needs_of_inversion<Options>,
       .objection = objection_of_inversion<Options>}));
}

}  // namespace isoline::optimizers
