// The phrases of a comparison that every format uses.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/comparison.h"

namespace isoline::reports {

std::string headline(const Comparison& comparison);  // "33 optimizers on 16 problems, …"
std::string status_meaning(Status status);           // "used up their work or iterations"
std::string status_text(const std::map<Status, std::size_t>& statuses);  // "target 3, budget 2"

// "118 of 120 cells, missing: sine / gd / seed 3; …". Empty where nothing is missing.
std::string missing_text(const Comparison& comparison);

// What a reader must know before believing the tables.
std::vector<std::string> remarks(const Comparison& comparison);

// "4/5, 1 failed": runs that reached the tolerance of all runs; is_complete says that nothing is
// lacking, so that small tables may leave it out.
std::string count_text(const Cell& cell, std::size_t tolerance);
bool is_complete(const Cell& cell, std::size_t tolerance);

// The median work, ✗, "n/a", "missing", or nothing where nothing was planned.
std::string matrix_text(const Cell& cell, std::size_t tolerance);

// The command that asks for the same cell again: all its options explicit, no table of rates.
std::string rerun_command(const Request& request);
std::string budget_options(const Request& request);  // "--iterations 1000 --rates none"

}  // namespace isoline::reports
