// The network's own step, shared by the methods that work by a proxy loss in x.
#include "optimizers/network_descent.h"

namespace isoline::optimizers {
namespace {

constexpr const char* kAutomatic = "auto";

}  // namespace

std::string NetworkDescent::rule_of(const std::string& option, bool has_identity_network) {
  if (option != kAutomatic) return option;
  return has_identity_network ? "gd[rate=1]" : "adam[rate=1e-3]";
}

std::vector<std::string> NetworkDescent::inside(const OptionValues& options, bool is_learning) {
  return {rule_of(options.text("network-optimizer"), !is_learning)};
}

NetworkDescent::NetworkDescent(const OptimizerRegistry& registry, const std::string& spec)
    : registry_(registry), is_automatic_(spec == kAutomatic) {
  if (!is_automatic_) rule_ = make_descent(registry, spec);
}

void NetworkDescent::start(const Meter& f) {
  if (is_automatic_) rule_ = make_descent(registry_, rule_of(kAutomatic, f.has_identity_network()));
  rule_->start(f.unknowns());
  gradient_.resize(f.unknowns());
}

void NetworkDescent::approach(const Matrix& found, Proxy proxy, Linearization& at, Vector& theta) {
  pull_ = at.x() - found;
  if (proxy == Proxy::l1) pull_ = pull_.cwiseSign();
  pull_ /= static_cast<Real>(pull_.cols());
  at.network_pullback(pull_, gradient_);
  rule_->update(gradient_, theta);
}

}  // namespace isoline::optimizers
