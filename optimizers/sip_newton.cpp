// A network taught by Newton's step in x, sample by sample, as the published script for Fig. 2 of
// Holl, Koltun, Thuerey (2022) has it besides its curves: x̃ = x − sign(g) |g/h| with g and h the
// first and second derivative of ½‖P(x) − y*‖², plain; with |x̃ − x| at most 0.1, clipped; or with
// 0.01 added to h, damped. For several inputs g and h are taken along the Hessian's eigenvectors.

#include "optimizers/inversion.h"
#include "optimizers/network_descent.h"

namespace isoline::optimizers {
namespace {

struct Options {
  Real clip = 0, damping = 0;
  std::string network_optimizer = "auto";
};

void fields(Options& o, auto& field) {
  field("clip", o.clip, at_least(0), "longest step along an eigenvector; 0: no limit");
  field("damping", o.damping, at_least(0), "what is added to each eigenvalue");
  field("network-optimizer", o.network_optimizer, Choices{}, NetworkDescent::kDoc);
}

class SipNewton final : public ProxyMethod {
 public:
  SipNewton(const Options& options, const OptimizerRegistry& registry)
      : ProxyMethod(registry, options.network_optimizer),
        inversion_(inversion_by_plain_newton(options.clip, options.damping)) {}
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    inversion_->invert(f, at_, found_);
    descent_.approach(found_, Proxy::l2, at_, theta);
    return Status::running;
  }

 private:
  std::unique_ptr<Inversion> inversion_;
};

std::string objection(const OptionValues&, const Problem& problem) {
  return objection_to_newton(problem, "Newton's step in x");
}

}  // namespace

void register_sip_newton(OptimizerRegistry& registry) {
  registry.add(proxy_entry<SipNewton, Options>(
      {.name = "sip-newton",
       .title = "Network trained by Newton's step in x",
       .formula = "x̃ = x − sign(g) |g/h|,  g = ∂L/∂x, h = ∂²L/∂x²;  "
                  "θ ← one step on (1/B) Σ ½‖x − x̃‖²",
       .source = "Holl, Koltun, Thuerey (2022), published script: train_exp.py",
       .note = "The script's variants are clip=0.1 and damping=0.01; none is in a figure.",
       .needs = {Oracle::forward, Oracle::network, Oracle::sensitivity, Oracle::curvature},
       .is_input_scale_invariant = true,
       .tunable = {.option = "network-optimizer"},
       .in_all = false,
       .objection = objection}));
}

}  // namespace isoline::optimizers
