// Moré, Garbow and Hillstrom's problems from their standard starts, by Levenberg-Marquardt: Ceres'
// and ours. Solved: f = Σr² = 2L ≤ f* (1 + 1e-6) where f* > 0, else f ≤ 1e-12. A candidate is a
// point at which the residuals were evaluated.
#include <gtest/gtest.h>

#include <cmath>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/execute.h"

namespace isoline::benchmarks {

using problems::Point;
using problems::Problem;
namespace {

const std::vector<std::string> kZeroResidual = {
    "rosenbrock",     "powell-singular",     "beale",
    "helical-valley", "brown-badly-scaled",  "box3d",
    "wood",           "broyden-tridiagonal", "variably-dimensioned"};

// τ for which f_L + τ (f₀ − f_L) is the loss of the criterion.
Real target_of(const Problem& problem) {
  Point at;
  problem.forward(problem.start(), at);
  const Real least = problem.minimum().value();
  const Real allowed = least > 0 ? 1e-6 * least : 0.5e-12;
  return allowed / (at.loss - least);
}

// Candidates until the problem was solved; infinite where it was not.
Real candidates(const std::string& name, const std::string& optimizer, std::int64_t most = 20000) {
  const Catalog catalog = builtin_catalog();
  const Component problem = complete_problem(catalog, name, OptionValues());
  constexpr std::int64_t kAnyWork = 10000000;  // counted in candidates here, not in work
  const Request request =
      named({.problem = problem,
             .optimizer = complete_optimizer(catalog, optimizer, OptionValues()),
             .budget = {.iterations = most,
                        .work = kAnyWork,
                        .target = target_of(make_problem(catalog, problem, 0))}});
  const auto trace = std::make_unique<Trace>();
  execute(catalog, request, *trace);
  const auto forwards = static_cast<Real>(trace->last.counts[static_cast<int>(Oracle::forward)]);
  const bool is_solved = trace->status == Status::target && forwards <= static_cast<Real>(most);
  return is_solved ? forwards : std::numeric_limits<Real>::infinity();
}

TEST(ClassicalProblems, AreSolvedByCeresAndByOurs) {
  for (const std::string& name : kZeroResidual)
    for (const char* optimizer : {"ceres-lm", "levenberg-marquardt"})
      EXPECT_LE(candidates(name, optimizer, 2000), 2000) << name << " by " << optimizer;
}

TEST(ClassicalProblems, BrownAndDennisIsSolvedByCeresWithRoomAndByOursWithout) {
  EXPECT_LE(candidates("brown-dennis", "ceres-lm"), 20000);
  EXPECT_LE(candidates("brown-dennis", "levenberg-marquardt"), 500);
}

TEST(ClassicalProblems, OursNeedsAsFewCandidatesAsCeres) {
  Real logarithms = 0;
  for (const std::string& name : kZeroResidual) {
    const Real ours = candidates(name, "levenberg-marquardt"),
               theirs = candidates(name, "ceres-lm");
    logarithms += std::log(ours / theirs);
    RecordProperty(name, std::to_string(ours) + " / " + std::to_string(theirs));
  }
  const Real mean = std::exp(logarithms / static_cast<Real>(kZeroResidual.size()));
  EXPECT_LE(mean, 1.1) << "geometric mean of ours / Ceres";
}

}  // namespace
}  // namespace isoline::benchmarks
