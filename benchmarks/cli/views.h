// Views of a study on the terminal, in place of the ranking: --view of `run` and `report`.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/cli/verb.h"
#include "core/results/study.h"

namespace isoline::benchmarks {

struct View {
  std::string name;                             // digits or choice
  std::vector<std::string> have = {"forward"};  // what a user's simulator computes
  int unknowns = 0;                             // 0: any
  double noise = 0, tolerance = 1e-6;
  bool bounds = false, failures = false;
  std::int64_t budget = kMostAmount;
};

Argument declare_view(VerbArguments& verb, std::string& name);
void declare_choice(VerbArguments& verb, const Argument& choice, View& view);  // its --have, …
void print_view(const results::Study& study, const View& view);

}  // namespace isoline::benchmarks
