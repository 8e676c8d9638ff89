// Problems that shared libraries bring (core/foreign/isoline.h), as entries of the registry.
#pragma once

#include "core/foreign/plugin_library.h"
#include "problems/problem.h"

namespace isoline::problems {

void add_plugin_physics(ProblemRegistry& registry, const PluginComponent& component);

}  // namespace isoline::problems
