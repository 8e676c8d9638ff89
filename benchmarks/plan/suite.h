// A suite or a user's own study: problems, optimizers, seeds and budgets. Its selectors, its
// expansion into requests, and its size.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/rates.h"
#include "core/records/request.h"
#include "core/spec.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

// One block of a suite. Problems and optimizers are specs or selectors.
struct MatrixBlock {
  std::vector<std::string> problems, optimizers;
  std::vector<std::string> except_problems, except_optimizers;  // names
  std::vector<std::string> features = {};  // of each problem in turn: "plain", "noise=0.01"
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
  std::int64_t version = 0;  // 0: none is stated
  std::vector<MatrixBlock> blocks;
  OptionValues problem_options = {};  // of every problem, besides those of its spec

  std::string label() const;  // "quick@1", as plans name it
};

// The spec's own options, and those of the row that it leaves open; the row may be null.
Component with_rates(const Catalog& catalog, const Spec& spec, const Rates::Row* row);

// The name of a suite in the tree, or the path of a file.
Suite read_suite(const std::string& name_or_path);
// UsageError with the file and the place where its JSON violates the schema of that name.
void require_valid(const Json& json, const std::string& schema, const std::string& origin);

// τ of the stopping rule "discrepancy[tau=1.1]"; 0 of "none".
Real discrepancy_of(const std::string& stop);

Suite suite_from_json(const Json& json, const std::string& origin);

inline constexpr std::uint64_t kMostCells = 1'000'000;

// Every cell, in order, each once. Options not given are filled in from the rates, then defaults.
// UsageError, before anything is made, where the plan has more than `most` cells.
std::vector<Request> expand(const Catalog& catalog, const Suite& suite, const Rates& rates,
                            std::uint64_t most = kMostCells);

// "*" for all, "@family" for the optimizers of a family; "@matrix-free", "@factorizing" (a dense
// factorization of size n) and "@derivative-free" by what a step costs; "@peers" for the scripts of
// clients/peers that run here, only in a list of optimizers.
bool is_selected(const OptimizerEntry& entry, const std::string& selector);

// The cells whose problem and optimizer match one of the names: specs, whose options a component
// must have, or selectors of optimizers. An empty text matches all. UsageError if a name is
// unknown, or if no cell is left.
std::vector<Request> filtered(const Catalog& catalog, std::vector<Request> requests,
                              const std::string& problems, const std::string& optimizers);

// How large a plan is, counted by multiplication before anything of it is made.
struct PlanSize {
  std::uint64_t cells = 0;  // at most: a cell that two blocks have is run once
  std::string largest;  // the factors of the largest block: "50,000 seeds × 400 settings of sine"
};

PlanSize size_of(const Catalog& catalog, const Suite& suite);

// "the plan has 20,000,000 cells, more than 1,000,000: 50,000 seeds × 400 settings of sine"
std::string too_large(const PlanSize& size, std::uint64_t most);

}  // namespace isoline::benchmarks
