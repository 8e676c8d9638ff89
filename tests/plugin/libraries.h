// Catalogs with the libraries that the tests build, and cells run on them.
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {

inline const std::string kPlugins = ISOLINE_PLUGINS;
inline const std::string kTrials = kPlugins + "/trials.so";

// As long as it lives one thing is wrong with the first component of trials.so.
class Defect {
 public:
  explicit Defect(const char* name) { setenv("ISOLINE_DEFECT", name, 1); }
  ~Defect() { unsetenv("ISOLINE_DEFECT"); }
  Defect(const Defect&) = delete;
  Defect& operator=(const Defect&) = delete;
};

inline Catalog catalog_with(const std::vector<std::string>& libraries) {
  Catalog catalog = builtin_catalog();
  for (const std::string& library : libraries) add_plugin(catalog, kPlugins + "/" + library);
  return catalog;
}

inline FinishedMatrix run(const Catalog& catalog, const std::vector<std::string>& problems,
                          const std::vector<std::string>& optimizers) {
  const Suite suite{.name = "plugin",
                    .title = "",
                    .blocks = {{.problems = problems,
                                .optimizers = optimizers,
                                .seeds = {0},
                                .budget = {.iterations = 300, .work = 3000}}}};
  return {catalog, suite, {}};
}

}  // namespace isoline::benchmarks
