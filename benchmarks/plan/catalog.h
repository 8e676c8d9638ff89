// The two registries together: what a benchmark can be made of.
#pragma once

#include "core/records/request.h"
#include "core/spec.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

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

}  // namespace isoline::benchmarks
