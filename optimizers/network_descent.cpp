// The network's own step, shared by the methods that work by a proxy loss in x.
#include "optimizers/network_descent.h"

namespace isoline::optimizers {

NetworkDescent::NetworkDescent(const OptimizerRegistry& registry, const std::string& spec)
    : registry_(registry), is_automatic_(spec == "auto") {
  if (!is_automatic_) rule_ = make_descent(registry, spec);
}

void NetworkDescent::start(const Meter& f) {
  if (is_automatic_)
    rule_ = make_descent(registry_, f.has_identity_network() ? "gd[rate=1]" : "adam[rate=1e-3]");
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
