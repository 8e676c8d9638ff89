// The registry's view of a network: its name, description and options, and how to create it.
// Without Eigen, for code that names networks and does not compute with them.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/options.h"
#include "core/real.h"
#include "core/registry.h"

namespace isoline::networks {

class Network;

// The shapes of a network's input and output. Grids are columns of channels·N² numbers, channel by
// channel, each N×N column major.
struct NetworkShape {
  Index inputs, outputs;                          // i, k
  Index grid = 0;                                 // N where samples are grids, else 0
  Index input_channels = 1, output_channels = 1;  // of grids
};

struct NetworkEntry {
  std::string name, title;
  std::string source;  // author, year, equation
  std::string note = {};
  OptionTable options = {};
  std::string file = {};  // that registers it, as the registry saw it
  std::function<std::unique_ptr<Network>(const OptionValues& complete_options, const NetworkShape&)>
      make = {};
};
using NetworkRegistry = Registry<NetworkEntry>;

// Every network, registered once.
const NetworkRegistry& network_registry();

void register_networks(NetworkRegistry& registry);  // generated: one call per file

}  // namespace isoline::networks
