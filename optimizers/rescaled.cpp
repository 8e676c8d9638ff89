// Gradients rescaled to unit length in x, Holl, Koltun, Thuerey (2022), Fig. 2: the network moves
// toward x̃ = x − d/‖d‖, d = ∂L/∂x, sample by sample, by (1/B) Σ ½‖x − x̃‖². The published script
// has one x and takes its sign from the known solution, x̃ = x + sign(x* − x), which for a monotone
// P is the same.

#include "optimizers/network_descent.h"

namespace isoline::optimizers {
namespace {

struct Options {
  std::string by = "gradient", network_optimizer = "auto";
};
void fields(Options& o, auto& field) {
  field("by", o.by, Choices{"gradient", "truth"},
        "where the direction comes from: −∂L/∂x, or x* − x (extra information)");
  field("network-optimizer", o.network_optimizer, Choices{}, NetworkDescent::kDoc);
}

class Rescaled final : public ProxyMethod {
 public:
  Rescaled(const Options& options, const OptimizerRegistry& registry)
      : ProxyMethod(registry, options.network_optimizer), is_by_truth_(options.by == "truth") {}
  Status step(Meter& f, Vector& theta) override {
    f.linearize(theta, at_);
    if (is_by_truth_) {
      slope_ = at_.x() - f.truth();
    } else {
      at_.cotangent(g_);
      slope_.resizeLike(at_.x());
      at_.physics_pullback(g_, slope_);
    }
    found_ = at_.x();
    for (Index b = 0; b < found_.cols(); ++b) {
      const Real largest = slope_.col(b).cwiseAbs().maxCoeff();
      if (largest == 0) continue;
      slope_.col(b) /= largest;  // squares of 1e-200 would vanish
      found_.col(b) -= slope_.col(b) / slope_.col(b).norm();
    }
    descent_.approach(found_, Proxy::l2, at_, theta);
    return Status::running;
  }

 private:
  const bool is_by_truth_;
  Matrix g_;      // (m, B)
  Matrix slope_;  // (k, B) ∂L/∂x
};

OracleSet needs_for(const OptionValues& options, const Problem&) {
  OracleSet needs{Oracle::forward, Oracle::network};
  needs.add(read_options<Options>(options).by == "truth" ? Oracle::truth : Oracle::pullback);
  return needs;
}

}  // namespace

void register_rescaled(OptimizerRegistry& registry) {
  registry.add(proxy_entry<Rescaled, Options>(
      {.name = "rescaled",
       .title = "Rescaled gradients",
       .formula = "x̃ = x − d/‖d‖,  d = ∂L/∂x;  θ ← one step on (1/B) Σ ½‖x − x̃‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 2",
       .note = "by=truth uses d = x − x*, as in the published script.",
       .needs = {Oracle::forward, Oracle::network},
       .tunable = {.option = "network-optimizer", .below = 6},
       .needs_for = needs_for}));
}

}  // namespace isoline::optimizers
