// What a command line asks to be run: its cells, under which name, and where their records go.
// `run`, `plan` and `submit` read it alike.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/plan/rates.h"
#include "benchmarks/run/preview.h"

namespace isoline::benchmarks {

struct RunArguments;

struct Undertaking {
  std::string name;
  std::vector<Request> requests;
  std::filesystem::path folder;
  Rates rates = {};
};

// A suite, whole or the part of it that --problem and --optimizer keep; or a matrix of these alone.
// Only a whole suite goes to the folder of its name: a part there would pass for the whole.
Undertaking undertaking_of(const RunArguments& given, const Catalog& catalog);

// --retry as statuses. What was interrupted is run again without it.
std::set<Status> statuses_of(const std::vector<std::string>& names);

// "36 cells: 4 cached, 2 inapplicable, 30 to run, about 12 s with 2 at a time"
std::string words_of(const PreviewCounts& counts, int jobs);

// What of a plan would be run, and how long it may take, as all who ask are told it.
void print_counts(const Preview& shown, int jobs);

}  // namespace isoline::benchmarks
