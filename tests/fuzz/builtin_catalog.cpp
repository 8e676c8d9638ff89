// The components of the tree, for the targets that need them.
#include "benchmarks/plan/catalog.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

// But for those that start the program that they are told: what is invented here is never run.
const benchmarks::Catalog& catalog() {
  static const benchmarks::Catalog all = [] {
    benchmarks::Catalog whole = benchmarks::builtin_catalog();
    return benchmarks::Catalog{whole.problems.ready(), whole.optimizers.ready()};
  }();
  return all;
}

}  // namespace isoline::fuzz
