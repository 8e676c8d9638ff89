// Chooses methods by what they need, from the runs of a study.
#include "core/results/advice.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "core/oracle.h"

namespace isoline::results {
namespace {

// Whether a reader with these means can ask for it.
bool can_ask(const Means& means, Oracle oracle) {
  switch (oracle) {
    case Oracle::forward:
    case Oracle::network:
      return true;
    case Oracle::pullback:
    case Oracle::layer_factors:
    case Oracle::layer_moments:
      return means.derivatives >= Derivatives::gradient;
    case Oracle::pushforward:
    case Oracle::jacobian:
    case Oracle::sparse_jacobian:
    case Oracle::sensitivity:
      return means.derivatives >= Derivatives::jacobian;
    case Oracle::hessian:
    case Oracle::curvature:
    case Oracle::hessian_product:
      return means.derivatives >= Derivatives::hessian;
    case Oracle::inverse:
      return means.has_inverse;
    case Oracle::truth:
      return false;
  }
  return false;
}

bool can_see(const Means& means, const std::string& privilege) {
  if (privilege == name_of(Privilege::exact_hessian))
    return means.derivatives >= Derivatives::hessian;
  return means.has_inverse && is_inverse_of_physics(privilege);
}

bool can_run(const Comparison& c, const Cell& cell, const Means& means) {
  return std::ranges::all_of(cell.privileges,
                             [&](const std::string& one) { return can_see(means, one); }) &&
         std::ranges::all_of(cell.runs, [&](std::size_t run) {
           const OracleCounts& counts = c.runs[run].record->counts;
           for (std::size_t kind = 0; kind < kOracles; ++kind)
             if (counts[kind] > 0 && !can_ask(means, static_cast<Oracle>(kind))) return false;
           return true;
         });
}

// Classical and toy problems count where there is little physics of that size.
std::vector<std::size_t> settings_of_size(const Comparison& c, const Means& means) {
  std::vector<std::size_t> settings;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const ProblemAxis& problem = c.problems[p];
    const Index unknowns = problem.sheet == nullptr ? 0 : problem.sheet->unknowns;
    if (!problem.is_learned && !problem.is_ill_posed() && unknowns >= means.least_unknowns &&
        unknowns <= means.most_unknowns)
      settings.push_back(p);
  }
  std::set<std::string> physics;
  const auto is_physics = [&](std::size_t p) { return c.problems[p].group() == "physics"; };
  for (const std::size_t p : settings)
    if (is_physics(p)) physics.insert(c.problems[p].name);
  constexpr std::size_t kFew = 4;
  if (physics.size() >= kFew)
    std::erase_if(settings, [&](std::size_t p) { return !is_physics(p); });
  return settings;
}

// The rows of each method, in their order.
std::vector<std::vector<std::size_t>> rows_by_method(const Comparison& c) {
  std::vector<std::vector<std::size_t>> methods;
  std::map<std::string, std::size_t> places;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const auto [at, is_new] = places.try_emplace(c.optimizers[s].name_of_all(), methods.size());
    if (is_new) methods.emplace_back();
    methods[at->second].push_back(s);
  }
  return methods;
}

}  // namespace

Advice advise(const Comparison& c, const Means& means) {
  Advice advice{.settings = settings_of_size(c, means), .ranked = {}, .partial = {}};
  const auto methods = rows_by_method(c);
  Evidence evidence{
      .costs = Costs(advice.settings.size(), std::vector<std::optional<Real>>(methods.size())),
      .families = {},
      .repetitions = {},
      .others = {}};
  std::vector<Advised> all(methods.size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::size_t most = 0;
    std::vector<Real> works;
    for (const std::size_t s : methods[m]) {
      std::size_t settings = 0;
      for (std::size_t i = 0; i < advice.settings.size(); ++i) {
        const Cell& cell = c.cell(advice.settings[i], s);
        if (cell.planned == 0 || evidence.costs[i][m] || !can_run(c, cell, means)) continue;
        const Real work = cell.median(Measure::work, c.yardstick.tightest().rung);
        works.push_back(work <= means.budget ? work : kNever);
        evidence.costs[i][m] = works.back();
        settings += cell.is_measured();
      }
      if (settings <= most) continue;
      most = settings;
      all[m].optimizer = s;
    }
    if (most == 0)  // it can be run nowhere
      for (auto& row : evidence.costs) row[m].reset();
    all[m].settings = most == 0 ? 0 : works.size();
    all[m].solved = std::size_t(std::ranges::count_if(works, [](Real w) { return w < kNever; }));
    all[m].work = median_of(std::move(works));
  }
  for (const std::size_t p : advice.settings) evidence.families.push_back(c.problems[p].name);
  const auto decision = advice.settings.empty() ? std::nullopt : decide(evidence);
  for (std::size_t i = 0; decision && i < decision->places.size(); ++i) {
    const Place& place = decision->places[i];
    advice.ranked.push_back(all[place.method]);
    advice.ranked.back().score = place.score;
    advice.ranked.back().is_in_group = place.is_in_group;
  }
  for (const Advised& one : all)
    if (one.settings > 0 && one.settings < advice.settings.size()) advice.partial.push_back(one);
  return advice;
}

}  // namespace isoline::results
