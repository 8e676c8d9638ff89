// The catalog made once: `--help` and `--version` need none.
#include "benchmarks/cli/session.h"

#include <fmt/format.h>

#include "benchmarks/plan/plugins.h"
#include "benchmarks/run/isolated_text.h"

namespace isoline::benchmarks {
namespace {

// Once in a process of its own: what crashes while it is loaded is told, and costs nothing else.
void require_loadable(const std::string& path) {
  constexpr double kSeconds = 30;
  const auto load = [&] {
    Catalog alone;
    try {
      add_plugin(alone, path);
    } catch (const UsageError&) {  // which this process then meets itself
    }
    return std::string();
  };
  const IsolatedText loaded = isolated_text(load, kSeconds);
  require(loaded.text.has_value(),
          [&] { return fmt::format("{}: it cannot be loaded: {}", path, loaded.failure); });
}

}  // namespace

Session::Session(std::string command, std::function<Catalog()> make)
    : command_(std::move(command)), make_(std::move(make)) {}

const Catalog& Session::catalog() {
  if (catalog_) return *catalog_;
  Catalog made = make_();
  for (const std::string& path : plugins_) {
    require_loadable(path);
    add_plugin(made, path);
  }
  catalog_ = std::make_shared<const Catalog>(std::move(made));
  return *catalog_;
}

}  // namespace isoline::benchmarks
