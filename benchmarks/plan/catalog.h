// The parts of a benchmark: the registries of problems and optimizers, and the files of the
// tree that are built into the program. Without Eigen: a file that makes a problem or runs an
// optimizer includes problems/problem.h or optimizers/optimizer.h besides.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/records/request.h"
#include "core/spec.h"
#include "optimizers/optimizer_entry.h"
#include "problems/problem_entry.h"

namespace isoline::benchmarks {

using optimizers::Meter;
using optimizers::Optimizer;
using optimizers::OptimizerEntry;
using optimizers::OptimizerRegistry;
using problems::Draw;
using problems::Inverse;
using problems::Point;
using problems::Problem;
using problems::ProblemEntry;
using problems::ProblemRegistry;

struct Catalog {
  ProblemRegistry problems{"problem"};
  OptimizerRegistry optimizers{"optimizer"};
};

Catalog builtin_catalog();  // everything in problems/ and optimizers/

// Adds what a shared library brings. UsageError, which names the path, where it is no plugin or a
// name is taken.
void add_plugin(Catalog& catalog, const std::string& path);

// A component as a request names it, its options complete.
Component complete_problem(const Catalog& catalog, const std::string& name,
                           const OptionValues& options);
Component complete_problem(const Catalog& catalog, const Spec& spec);
Component complete_optimizer(const Catalog& catalog, const std::string& name,
                             const OptionValues& options);
Component complete_optimizer(const Catalog& catalog, const Spec& spec);

// With the best loss known for f_L, where it declares none.
Problem make_problem(const Catalog& catalog, const Component& problem, std::uint64_t seed);
bool declares_minimum(const Catalog& catalog, const Component& problem, std::uint64_t seed);

// The files of the tree, by name without ".json".
const std::map<std::string, std::string_view>& builtin_suites();
const std::map<std::string, std::string_view>& builtin_rates();
const std::map<std::string, std::string_view>& builtin_claims();
const std::map<std::string, std::string_view>& builtin_schemas();

std::string_view embedded_best();  // benchmarks/best.json

}  // namespace isoline::benchmarks
