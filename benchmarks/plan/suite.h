// A suite or a matrix of one's own: which problems meet which optimizers, on which seeds, with what
// budget. Expands into requests.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/rates.h"
#include "core/records/request.h"
#include "core/spec.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

// One block of a suite. Problems and optimizers are specs or selectors (benchmarks/plan/filter.h).
struct MatrixBlock {
  std::vector<std::string> problems, optimizers;
  std::vector<std::string> except_problems, except_optimizers;  // names
  std::vector<std::uint64_t> seeds = {0};
  Budget budget;
  int threads = 1;
  double hard_seconds = 0;  // when a cell is killed; 0: the standard limit
  // The one table to look in, or "none", which leaves all at the defaults; empty: all tables that
  // are not of tuned rates.
  std::string rates;
};

struct Suite {
  std::string name, title;
  std::vector<MatrixBlock> blocks;
};

// The spec's own options, and those of the row that it leaves open; the row may be null.
Component with_rates(const Catalog& catalog, const Spec& spec, const Rates::Row* row);

// The name of a suite in the tree, or the path of a file.
Suite read_suite(const std::string& name_or_path);
Suite suite_from_json(const Json& json, const std::string& origin);

inline constexpr std::uint64_t kMostCells = 1'000'000;

// Every cell, in order, each once. Options not given are filled in from the rates, then defaults.
// UsageError, before anything is made, where the plan has more than `most` cells.
std::vector<Request> expand(const Catalog& catalog, const Suite& suite, const Rates& rates,
                            std::uint64_t most = kMostCells);

}  // namespace isoline::benchmarks
