// Two-stage supervised training: the network learns labels alone, (1/B) Σ ½‖x − x*‖², with x* the
// input that produced y*. The physics is used only for the data. Where several x give
// the same y* it learns their mean, which solves nothing: Holl, Koltun, Thuerey (2022).

#include "optimizers/network_descent.h"

namespace isoline::optimizers {
namespace {

struct Options {
  std::string network_optimizer = "auto";
};
void fields(Options& o, auto& field) {
  field("network-optimizer", o.network_optimizer, Choices{}, NetworkDescent::kDoc);
}

class Supervised final : public ProxyMethod {
 public:
  Supervised(const Options& options, const OptimizerRegistry& registry)
      : ProxyMethod(registry, options.network_optimizer) {}
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    descent_.approach(f.truth(), Proxy::l2, at_, theta);
    return Status::running;
  }

 private:
};

// Without a network, its first step would be the answer itself.
std::string objection(const OptionValues&, const Problem& problem) {
  return problem.has_identity_network() ? "it uses x*, and there is no network to learn it" : "";
}

}  // namespace

void register_supervised(OptimizerRegistry& registry) {
  registry.add(proxy_entry<Supervised, Options>(
      {.name = "supervised",
       .title = "Supervised training",
       .formula = "θ ← one step on (1/B) Σ ½‖x − x*‖²",
       .source = "Holl, Koltun, Thuerey (2022)",
       .note = "Uses the x* that produced each y*. If the inverse has several branches, it "
               "learns their mean. The forward pass counts completely, including the physics.",
       .needs = {Oracle::forward, Oracle::network, Oracle::truth},
       .is_input_scale_invariant = true,
       .tunable = {.option = "network-optimizer"},
       .objection = objection}));
}

}  // namespace isoline::optimizers
