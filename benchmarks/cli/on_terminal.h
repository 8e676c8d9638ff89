// What several verbs say on the terminal.
#pragma once

#include "core/threads.h"

namespace isoline::benchmarks {

struct Outcome;

// A live line of how far the work is, on a terminal; nothing elsewhere.
Listener on_terminal(const char* what);

// Failures and conflicts on standard error; how many cells ended how, unless quiet.
void print_outcome(const Outcome& outcome, bool quiet);

// What the runs alone say: interrupted, which it tells the user; worse where any failed; good.
int exit_code_of(const Outcome& outcome);

}  // namespace isoline::benchmarks
