// What several verbs say on the terminal.
#pragma once

#include <filesystem>

#include "core/threads.h"

namespace isoline::benchmarks {

struct Outcome;

// A live line of how far the work is, on a terminal; nothing elsewhere.
Listener on_terminal(const char* what);

// On standard error, twenty at most; of a crash how to look into it.
void print_failures(const Outcome& outcome, const std::filesystem::path& folder);

// Failures and conflicts on standard error; how many cells ended how and in what time, unless
// quiet.
void print_outcome(const Outcome& outcome, const std::filesystem::path& folder, bool quiet);

// What the runs alone say: interrupted, which it tells the user; worse where any failed; good.
int exit_code_of(const Outcome& outcome);

}  // namespace isoline::benchmarks
