// Output common to several verbs: progress, the outcome of runs, the report of a study.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/cli/verb.h"
#include "core/threads.h"
#include "reports/report.h"

namespace isoline::benchmarks {

struct Outcome;

// A live line of how far the work is, on a terminal; nothing elsewhere.
Listener progress_on_terminal(const char* what);

// On standard error, twenty at most; for a crash also how to debug it.
void print_failures(const Outcome& outcome, const std::filesystem::path& folder);

// Failures and conflicts on standard error; the number of cells by status and the time, unless
// quiet.
void print_outcome(const Outcome& outcome, const std::filesystem::path& folder, bool quiet);

// The exit code of the runs alone: interrupted, which is printed; worse where any failed; good.
int exit_code_of(const Outcome& outcome);

// A study reported: every format in a folder, with the claims that its runs decide; the main table
// on the terminal, unless quiet.
struct Reporting {
  bool is_quiet = false;
  reports::Yardstick yardstick = {};
};
void write_and_print(const reports::Study& study, const std::filesystem::path& out,
                     Session& session, const Reporting& how = {});

}  // namespace isoline::benchmarks
