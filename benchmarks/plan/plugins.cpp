// Components of a library, each to the registry of its kind.
#include "benchmarks/plan/plugins.h"

#include "core/foreign/plugin_library.h"

namespace isoline::benchmarks {

void add_plugin(Catalog& catalog, const std::string& path) {
  for (const PluginComponent& component : load_plugin(path)) try {
      if (component.is_optimizer)
        optimizers::add_plugin_method(catalog.optimizers, component);
      else
        problems::add_plugin_physics(catalog.problems, component);
    } catch (const UsageError& error) {
      throw UsageError(path + ": " + error.what());
    }
}

}  // namespace isoline::benchmarks
