// The verbs of the program but `help` and `version`, which the command line answers itself.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/cli/verbs.h"

namespace isoline::benchmarks {

class VerbArguments;

// Declares what it takes, and is run with what was then given.
struct Verb {
  std::string name, about;
  std::function<void(VerbArguments&)> declare;
  std::function<int(Session&)> run;  // its exit code
};

struct VerbTable {
  std::vector<Verb> verbs;                          // in the order of the help
  std::shared_ptr<const RunArguments> run;          // what `run` was given
  std::shared_ptr<CompletionArguments> completion;  // whose verbs the command line knows
};
VerbTable verb_table();

}  // namespace isoline::benchmarks
