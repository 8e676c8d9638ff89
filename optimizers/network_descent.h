// Drawing a network to the x̃ that a method has found: one step of a gradient rule on the proxy loss
// (1/B) Σ ½‖x − x̃‖², or (1/B) Σ |x − x̃|, with x̃ held. With the identity network and gd[rate=1] it
// is x ← x̃. The methods that do so, and what they have in common.
#pragma once

#include <memory>
#include <string>

#include "optimizers/optimizer.h"

namespace isoline::optimizers {

enum class Proxy { l2, l1 };

class NetworkDescent {
 public:
  static constexpr const char* kDoc =
      "gradient rule on the proxy loss; auto: gd[rate=1] for the identity network, else "
      "adam[rate=1e-3]";

  // The rule that the option network-optimizer stands for, of an identity network or another.
  static std::string rule_of(const std::string& option, bool has_identity_network);
  static std::vector<std::string> inside(const OptionValues& options, bool is_learning);

  // `spec` names the rule, or is "auto". The registry outlives this.
  NetworkDescent(const OptimizerRegistry& registry, const std::string& spec);
  void start(const Meter& f);
  void approach(const Matrix& found, Proxy proxy, Linearization& at, Vector& theta);
  bool persist(Archive& archive) { return rule_->persist(archive); }

 private:
  const OptimizerRegistry& registry_;
  bool is_automatic_;
  std::unique_ptr<Descent> rule_;
  Matrix pull_;      // (k, B), the proxy's gradient in x
  Vector gradient_;  // (n)
};

// A method whose step in θ is the network's own.
class ProxyMethod : public Optimizer {
 public:
  ProxyMethod(const OptimizerRegistry& registry, const std::string& rule)
      : descent_(registry, rule) {}
  void start(Meter& f, const Vector&) override { descent_.start(f); }
  bool persist(Archive& archive) override { return descent_.persist(archive); }

 protected:
  NetworkDescent descent_;
  Linearization at_;
  Matrix found_;  // (k, B) x̃
};

// Its entry: Method is made of Options, which hold a `network_optimizer`, and the registry.
template <class Method, class Options>
OptimizerEntry proxy_entry(OptimizerEntry entry) {
  entry.family = Family::inversion;
  entry.kind = Kind::inversion;
  entry.options = option_table<Options>();
  entry.inside = NetworkDescent::inside;
  entry.make = [](const OptionValues& options,
                  const OptimizerRegistry& known) -> std::unique_ptr<Optimizer> {
    return std::make_unique<Method>(read_options<Options>(options), known);
  };
  return entry;
}

}  // namespace isoline::optimizers
