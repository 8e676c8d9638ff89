// Common parts of networks: products that follow from others, and networks by name.
#include "networks/network.h"

#include <fmt/format.h>

#include "core/spec.h"

namespace isoline::networks {

void Network::curvature(VectorRef, BatchRef, BatchRef, VectorOut, Workspace&) const {
  throw std::logic_error("this network has no second derivatives");
}

void Network::jacobian(BatchRef dy_dx, BatchOut J, Workspace& w) const {
  const Index k = outputs(), m = dy_dx.rows(), samples = dy_dx.cols() / k;
  w.unit.setZero(k, samples);
  w.product.resize(parameters(), 1);
  for (Index b = 0; b < samples; ++b) {
    for (Index i = 0; i < m; ++i) {
      w.unit.col(b) = dy_dx.row(i).segment(b * k, k);
      pullback(w.unit, w.product.col(0), w);
      J.row(b * m + i) = w.product.col(0);
    }
    w.unit.col(b).setZero();
  }
}

void Network::layer_factors(BatchRef, std::vector<LayerFactor>&, Workspace&) const {
  throw std::logic_error("this network has no dense layers");
}

void Network::layer_moments(BatchRef, std::vector<LayerMoments>&, VectorOut, Workspace&) const {
  throw std::logic_error("this network has no convolutions");
}

Vector Network::statistics(VectorRef, BatchRef, Workspace&) const { return {}; }

void Network::infer(VectorRef theta, VectorRef, BatchRef in, BatchOut x, Workspace& w) const {
  forward(theta, in, x, w);
}

const NetworkRegistry& network_registry() {
  static const NetworkRegistry registry = [] {
    NetworkRegistry networks("network");
    register_networks(networks);
    return networks;
  }();
  return registry;
}

std::unique_ptr<Network> make_network(const std::string& text, const NetworkShape& shape) {
  const Spec spec = parse_spec(text);
  const NetworkEntry& entry = network_registry().at(spec.name);
  return entry.make(complete_options(entry.options, spec.name, options_of(spec)), shape);
}

}  // namespace isoline::networks
