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

class Supervised final : public Optimizer {
 public:
  Supervised(const Options& options, const OptimizerRegistry& registry)
      : descent_(registry, options.network_optimizer) {}
  void start(Meter& f, const Vector&) override { descent_.start(f); }
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    descent_.approach(f.truth(), Proxy::l2, at_, theta);
    return Status::running;
  }
  bool persist(Archive& archive) override { return descent_.persist(archive); }

 private:
  NetworkDescent descent_;
  Linearization at_;
};

// Without a network, its first step would be the answer itself.
std::string objection(const OptionValues&, const Problem& problem) {
  return problem.has_identity_network() ? "it uses x*, and there is no network to learn it" : "";
}

}  // namespace

void register_supervised(OptimizerRegistry& registry) {
  registry.add({.name = "supervised",
                .title = "Supervised training",
                .family = Family::inversion,
                .kind = Kind::inversion,
                .formula = "θ ← one step on (1/B) Σ ½‖x − x*‖²",
                .source = "Holl, Koltun, Thuerey (2022)",
                .note = "Sees the x* that made each y*. Where the inverse has several branches it "
                        "learns their mean. The forward pass is metered whole, physics included.",
                .needs = {Oracle::forward, Oracle::network, Oracle::truth},
                .is_input_scale_invariant = true,
                .options = option_table<Options>(),
                .tunable = {.option = "network-optimizer"},
                .inside = NetworkDescent::inside,
                .objection = objection,
                .make = [](const OptionValues& options,
                           const OptimizerRegistry& known) -> std::unique_ptr<Optimizer> {
                  return std::make_unique<Supervised>(read_options<Options>(options), known);
                }});
}

}  // namespace isoline::optimizers
