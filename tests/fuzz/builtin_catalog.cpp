// The components of the tree, for the targets that need them.
#include "benchmarks/plan/catalog.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

const benchmarks::Catalog& catalog() {
  static const benchmarks::Catalog all = benchmarks::builtin_catalog();
  return all;
}

}  // namespace isoline::fuzz
