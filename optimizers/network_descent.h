// Drawing a network to the x̃ that another method has found: one step of a gradient rule on the
// proxy loss (1/B) Σ ½‖x − x̃‖², or (1/B) Σ |x − x̃|, with x̃ held. With the identity network and
// gd[rate=1] it is x ← x̃.
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

}  // namespace isoline::optimizers
