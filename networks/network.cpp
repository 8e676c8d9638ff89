// Common parts of networks: products that follow from others, and networks by name.
#include "networks/network.h"

#include <fmt/format.h>

#include "core/spec.h"

namespace isoline::networks {

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
