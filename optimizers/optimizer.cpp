// Which optimizer can treat which problem, and gradient rules by name.
#include "optimizers/optimizer.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/oracle.h"
#include "core/spec.h"

namespace isoline::optimizers {

OracleSet needs_of(const OptimizerEntry& entry, const OptionValues& options,
                   const Problem& problem) {
  return entry.needs_for ? entry.needs_for(options, problem) : entry.needs;
}

std::vector<std::string> privileges_of(OracleSet granted, Inverse inverse) {
  std::vector<std::string> names;
  const auto add = [&](Privilege privilege) { names.emplace_back(name_of(privilege)); };
  if (granted.contains(Oracle::hessian) || granted.contains(Oracle::curvature))
    add(Privilege::exact_hessian);
  if (granted.contains(Oracle::inverse)) {
    if (inverse == Inverse::exact) add(Privilege::exact_inverse);
    if (inverse == Inverse::damped) add(Privilege::damped_inverse);
    if (inverse == Inverse::approximate) add(Privilege::approximate_inverse);
    if (inverse == Inverse::estimate) add(Privilege::estimate);
  }
  if (granted.contains(Oracle::truth)) add(Privilege::ground_truth);
  return names;
}

std::string why_inapplicable(const OptimizerEntry& entry, const OptionValues& options,
                             const Problem& problem) {
  const OracleSet offered = problem.offers(), needs = needs_of(entry, options, problem);
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    const auto oracle = static_cast<Oracle>(kind);
    if (!needs.contains(oracle) || offered.contains(oracle)) continue;
    const auto [rows, columns] = problem.dense_shape(oracle);
    constexpr Real kGibibyte = 1 << 30;
    if (!problem.is_dense_feasible(oracle))
      return fmt::format(
          "it needs a dense matrix of {} × {} numbers ({}), which takes {:.3g} GiB", rows, columns,
          name_of(oracle),
          sizeof(Real) * static_cast<Real>(rows) * static_cast<Real>(columns) / kGibibyte);
    return std::string(oracle_row(oracle).lack);
  }
  if (entry.needs_same_samples && problem.has_fresh_batches())
    return "it compares losses from step to step, which needs a finite data set (data=N)";
  if (problem.unknowns() > entry.most_unknowns && !needs.contains(Oracle::sparse_jacobian))
    return fmt::format("{} unknowns, and {} is limited to {}", problem.unknowns(), entry.name,
                       entry.most_unknowns);
  if (entry.kind == Kind::least_squares && !problem.is_least_squares())
    return "the loss is not a multiple of ‖y − y*‖², which least squares minimizes";
  // A method that needs products only factorizes nothing.
  const bool factorizes = needs.contains(Oracle::jacobian) || needs.contains(Oracle::layer_factors);
  const Index rank = std::min(problem.unknowns(), problem.residuals());
  if (factorizes && rank > entry.most_rank)
    return fmt::format("a Jacobian of rank {}, and {} is limited to {}", rank, entry.name,
                       entry.most_rank);
  if (problem.bounds() && problem.bounds()->are_needed && !entry.keeps_bounds)
    return "the problem has bounds on x, which this method does not respect";
  return entry.objection ? entry.objection(options, problem) : "";
}

std::unique_ptr<Descent> make_descent(const OptimizerRegistry& registry, const std::string& text) {
  const Spec spec = parse_spec(text);
  const OptimizerEntry& entry = registry.at(spec.name);
  require(static_cast<bool>(entry.make_descent), [&] {
    return fmt::format(
        "{} requires more than a gradient, so another method cannot use it as its network "
        "optimizer",
        spec.name);
  });
  return entry.make_descent(complete_options(entry.options, spec.name, options_of(spec)));
}

bool is_solved_sparse(const Problem& problem) {
  constexpr Index kLeastUnknowns = 256;  // below, dense factorizations take as long
  return problem.sparse_pattern() && problem.unknowns() >= kLeastUnknowns;
}

}  // namespace isoline::optimizers
