// The adapter to shared libraries: the components of a library, by the struct of
// core/foreign/isoline.h. Each is validated before any of its functions is called.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/foreign/foreign.h"
#include "core/options.h"
#include "core/real.h"

struct isoline_component;

namespace isoline {

struct PluginComponent {
  // A copy, which the library cannot change any more; what it points to lives as long as the
  // process.
  std::shared_ptr<const isoline_component> table;
  std::string name, title, formula, source, note;
  OptionTable options;
  std::string tuned;  // the tunable option, or empty
  Foreign foreign;
  bool is_optimizer = false;

  bool can(std::uint64_t capability) const;
  std::string words() const;  // "./libmine.so: spring"
};

// UsageError, which names the path, where it is no library, no plugin, of another version, or
// promises what it has not.
std::vector<PluginComponent> load_plugin(const std::string& path);

// One that is open as long as this lives.
class PluginInstance {
 public:
  PluginInstance(PluginComponent of, const OptionValues& options, std::uint64_t seed);
  ~PluginInstance();
  PluginInstance(const PluginInstance&) = delete;
  PluginInstance& operator=(const PluginInstance&) = delete;

  const PluginComponent& of() const { return of_; }
  const isoline_component& table() const { return *of_.table; }
  void* self() const { return self_; }

 private:
  const PluginComponent of_;
  void* self_ = nullptr;
};

}  // namespace isoline
