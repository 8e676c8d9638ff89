// Scale-invariant physics training, Holl, Koltun, Thuerey (2022), Fig. 3: pull the target back
// through the physics by its local inverse, x̃ = P⁻¹(y + Δy; x) with Δy = η (y* − y), then take a
// step of the network's optimizer on (1/B) Σ ½‖x − x̃‖², x̃ held. With the identity network and unit
// rates it is x ← x̃, the inverse-simulator update. Several steps of the inversion may be taken for
// one of the network, each from the x̃ of the last, and several of the network for one x̃; as many
// as theorem 3 of the paper requires are those of sip-theorem-3.
#include "optimizers/inversion.h"
#include "optimizers/network_descent.h"

namespace isoline::optimizers {
namespace {

struct Options {
  InversionOptions inversion;
  std::string network_optimizer = "auto", proxy = "l2";
  Index inner_steps = 1, network_steps = 1;

  bool falls_back() const { return inversion.fallback == "gradient"; }
};

void fields(Options& o, auto& field) {
  fields(o.inversion, field);
  field("network-optimizer", o.network_optimizer, Choices{}, NetworkDescent::kDoc);
  field("proxy", o.proxy, Choices{"l2", "l1"}, "proxy loss: ½‖x − x̃‖² or Σ|x − x̃|");
  field("inner-steps", o.inner_steps, between(1, 1e6), "steps of the inversion per update");
  field("fallback", o.inversion.fallback, Choices{"none", "gradient"},
        "where the problem's own inverse fails: the sample keeps its x; or it moves as by "
        "inverse=gradient, and a series of the record counts it");
  field("network-steps", o.network_steps, between(1, 1e6), "steps of the network toward each x̃");
}

class Sip final : public ProxyMethod {
 public:
  Sip(const Options& options, const OptimizerRegistry& registry)
      : ProxyMethod(registry, options.network_optimizer), options_(options) {}

  void start(Meter& f, const Vector& theta) override {
    inversion_ = make_inversion(options_.inversion, f.inverse_kind());
    ProxyMethod::start(f, theta);
    if (options_.falls_back()) f.name_series({"samples moved along the gradient"});
  }

  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    fallbacks_ += inversion_->invert(f, at_, found_);
    for (Index i = 1; i < options_.inner_steps && !f.is_spent(); ++i) {
      f.linearize_physics(found_, inner_);
      fallbacks_ += inversion_->invert(f, inner_, found_);
    }
    if (options_.falls_back()) f.note(0, static_cast<Real>(fallbacks_));
    const Proxy proxy = options_.proxy == "l1" ? Proxy::l1 : Proxy::l2;
    descent_.approach(found_, proxy, at_, theta);
    for (Index i = 1; i < options_.network_steps && !f.is_spent(); ++i) {
      f.linearize(theta, at_);
      descent_.approach(found_, proxy, at_, theta);
    }
    return Status::running;
  }

  bool persist(Archive& archive) override {
    archive(fallbacks_);
    return ProxyMethod::persist(archive);
  }

 private:
  const Options options_;
  std::unique_ptr<Inversion> inversion_;
  Linearization inner_;
  Index fallbacks_ = 0;  // samples so far
};

}  // namespace

void register_sip(OptimizerRegistry& registry) {
  registry.add(proxy_entry<Sip, Options>(
      {.name = "sip",
       .title = "Scale-invariant physics",
       .formula = "x̃ = P⁻¹(y + η (y* − y); x);  θ ← one step on (1/B) Σ ½‖x − x̃‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 3",
       .note = "The inverse is the problem's own, a saddle-free Newton step with exact second "
               "derivatives, or found by L-BFGS; if it is damped or an estimate, x̃ = x + "
               "η (P⁻¹(y*; x) − x), and for Newton x + η U. The problem's own inverse and its "
               "second derivatives are extra information; L-BFGS is not.",
       .needs = {Oracle::forward, Oracle::network},
       .is_input_scale_invariant = true,
       .tunable = {.option = "step", .below = 5},
       .needs_for = needs_of_inversion<Options>,
       .objection = objection_of_inversion<Options>}));
}

}  // namespace isoline::optimizers
