// The catalog made once: `--help` and `--version` need none.
#include "benchmarks/cli/session.h"

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

Session::Session(std::string command, std::function<Catalog()> make)
    : command_(std::move(command)), make_(std::move(make)) {}

const Catalog& Session::catalog() {
  if (!catalog_) catalog_ = std::make_shared<const Catalog>(make_());
  return *catalog_;
}

}  // namespace isoline::benchmarks
