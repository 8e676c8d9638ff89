// The whole program as a function, so that a binary built elsewhere has every verb over a catalog
// of its own:
//
//   Catalog with_mine() {
//     Catalog catalog = isoline::benchmarks::builtin_catalog();
//     register_mine(catalog.problems);
//     return catalog;
//   }
//   int main(int count, char** arguments) {
//     return isoline::main(count, arguments, with_mine, {kCommit, kDirty, kSources});
//   }
//
// These three stand in "isoline_build_info.h", which CMake's isoline_names_commit(target) writes at
// every build. Link Isoline::cli.
#pragma once

#include <functional>
#include <string>

#include "benchmarks/plan/catalog.h"

namespace isoline {

// The repository that a program was built from, which its records name; by default Isoline's.
// `sources` are digests of its files, one per line. Without them, each build of the program runs
// the cells of its own components again.
struct SourceTree {
  std::string commit;
  bool is_dirty = false;
  std::string sources = {};
};

// The first call of a main(): it may replace the process once, to give the libraries their
// environment. The catalog is made when a verb first needs it.
int main(int count, char** arguments, const std::function<benchmarks::Catalog()>& catalog,
         const SourceTree& tree = {});

}  // namespace isoline
