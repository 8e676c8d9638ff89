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

// The columns of a terminal at standard output, 60 at least; those of a pipe elsewhere.
reports::Columns output_columns();

// A live line with the progress, on a terminal only.
Listener progress_on_terminal(const char* what);

// Prints at most twenty failures on standard error, and after a crash the commands to debug it.
void print_failures(const Outcome& outcome, const std::filesystem::path& folder);

// Failures and conflicts on standard error; the number of cells by status and the time, unless
// quiet.
void print_outcome(const Outcome& outcome, const std::filesystem::path& folder, bool quiet);

// The exit code of the runs: interrupted, with a message; worse if a run failed; good.
int exit_code_of(const Outcome& outcome);

// Runs another program and waits for it; its output goes to a file where one is named. UsageError
// with the Debian package where it is not installed, or where it fails.
void run_program(std::vector<std::string> command, const char* package,
                 const std::filesystem::path& output = {});

// Runs a script of clients/python; its exit code. The script names Python packages that it lacks.
int run_script(const std::string& name, std::vector<std::string> arguments);

// Writes a report of a study in every format, with the claims that its runs decide, and prints the
// main table unless quiet.
struct Reporting {
  bool is_quiet = false;
  reports::Yardstick yardstick = {};
};
// The records of result folders without what no report reads; UsageError where there are none.
reports::Study study_of_report(const std::vector<std::string>& folders, Session& session);
reports::Document document_of_report(const reports::Study& study, Session& session,
                                     const reports::Yardstick& yardstick = {});
void write_and_print(const reports::Study& study, const std::filesystem::path& out,
                     Session& session, const Reporting& how = {});

}  // namespace isoline::benchmarks
