// Methods that shared libraries bring (core/foreign/isoline.h), as entries of the registry.
#pragma once

#include "core/foreign/plugin_library.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {

void add_plugin_method(OptimizerRegistry& registry, const PluginComponent& component);

}  // namespace isoline::optimizers
