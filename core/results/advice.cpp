// Selects and ranks methods by their requirements, from the runs of a study.
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

constexpr Real kNear = 3;  // noise of this factor less or more is of the same size

// Whether its data are as noisy as the reader's.
bool has_noise(const ProblemAxis& problem, Real noise) {
  return noise == 0 ? problem.noise == 0
                    : problem.noise >= noise / kNear && problem.noise <= noise * kNear;
}

// Classical and toy problems count where there is little physics of that size.
std::vector<std::size_t> settings_of_size(const Comparison& c, const Means& means) {
  std::vector<std::size_t> settings;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const ProblemAxis& problem = c.problems[p];
    const Index unknowns = problem.sheet == nullptr ? 0 : problem.sheet->unknowns;
    if (!problem.is_learned && !problem.is_ill_posed() && unknowns >= means.least_unknowns &&
        unknowns <= means.most_unknowns && has_noise(problem, means.noise) &&
        problem.is_bounded == means.has_bounds && problem.has_failures == means.has_failures)
      settings.push_back(p);
  }
  std::set<std::string> physics;
  const auto is_physics = [&](std::size_t p) { return c.problems[p].group() == "physics"; };
  for (const std::size_t p : settings)
    if (is_physics(p)) physics.insert(c.problems[p].family());
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

// Methods on settings: the median work of each, and what an advice says of each.
struct Trial {
  Costs costs;
  std::vector<Advised> all;
};

Trial trial_of(const Comparison& c, const Means& means, const std::vector<std::size_t>& settings,
               const std::vector<std::vector<std::size_t>>& methods) {
  Trial trial{Costs(settings.size(), std::vector<std::optional<Real>>(methods.size())),
              std::vector<Advised>(methods.size())};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::size_t most = 0;
    std::vector<Real> works;
    for (const std::size_t s : methods[m]) {
      std::size_t measured = 0;
      for (std::size_t i = 0; i < settings.size(); ++i) {
        const Cell& cell = c.cell(settings[i], s);
        if (cell.planned == 0 || trial.costs[i][m] || !can_run(c, cell, means)) continue;
        const Real work = cell.median(Measure::work, c.yardstick.tightest().rung);
        works.push_back(work <= means.budget ? work : kNever);
        trial.costs[i][m] = works.back();
        measured += cell.is_measured();
      }
      if (measured <= most) continue;
      most = measured;
      trial.all[m].optimizer = s;
    }
    if (most == 0)  // it can be run nowhere
      for (auto& row : trial.costs) row[m].reset();
    Advised& one = trial.all[m];
    one.settings = most == 0 ? 0 : works.size();
    one.solved = std::size_t(std::ranges::count_if(works, [](Real w) { return w < kNever; }));
    one.work = median_of(std::move(works));
  }
  return trial;
}

// The method that was run on some of the settings alone and solves more of them than the first of
// those that were run on all, if there is one: it would not be ranked. Of several, that with the
// most settings.
std::optional<std::size_t> better_on_some(const Trial& trial, std::optional<std::size_t> first) {
  constexpr std::size_t kFewest = 3;
  std::optional<std::size_t> better;
  for (std::size_t m = 0; m < trial.all.size(); ++m) {
    const std::size_t settings = trial.all[m].settings;
    if (settings < kFewest || settings == trial.costs.size() ||
        (better && settings <= trial.all[*better].settings))
      continue;
    std::size_t solved = 0;
    for (const auto& row : trial.costs)
      solved += first && row[m] && row[*first] && *row[*first] < kNever;
    if (trial.all[m].solved > solved) better = m;
  }
  return better;
}

}  // namespace

std::vector<Means> kinds_of_data(const Comparison& c) {
  std::vector<Means> kinds = {{}};
  std::set<Real> levels;
  for (const ProblemAxis& problem : c.problems)
    if (problem.noise > 0 && !problem.is_bounded && !problem.is_learned)
      levels.insert(problem.noise);
  for (const Real noise : levels)
    if (noise > kNear * kinds.back().noise) kinds.push_back({.noise = noise});
  if (std::ranges::any_of(c.problems, &ProblemAxis::is_bounded))
    kinds.push_back({.has_bounds = true});
  if (std::ranges::any_of(c.problems, &ProblemAxis::has_failures))
    kinds.push_back({.has_failures = true});
  return kinds;
}

Advice advise(const Comparison& c, const Means& means) {
  Advice advice{.settings = settings_of_size(c, means), .ranked = {}, .partial = {}};
  advice.of_size = advice.settings.size();
  const auto methods = rows_by_method(c);
  Trial trial = trial_of(c, means, advice.settings, methods);
  const auto ranked = [&] {
    Evidence evidence{.costs = trial.costs, .families = {}, .repetitions = {}, .others = {}};
    for (const std::size_t p : advice.settings) evidence.families.push_back(c.problems[p].family());
    return ranked_places(evidence);
  };
  auto places = ranked();
  if (const auto m =
          better_on_some(trial, places.empty() ? std::nullopt : std::optional(places[0].method))) {
    std::vector<std::size_t> shared;
    for (std::size_t i = 0; i < advice.settings.size(); ++i)
      if (trial.costs[i][*m]) shared.push_back(advice.settings[i]);
    advice.settings = std::move(shared);
    trial = trial_of(c, means, advice.settings, methods);
    places = ranked();
  }
  const auto is_missing = [&](const Run& run) {
    return std::ranges::find(advice.settings, run.problem) != advice.settings.end();
  };
  if (std::ranges::any_of(c.absent, is_missing)) return advice;  // nothing is tested
  for (const Place& place : places) {
    advice.ranked.push_back(trial.all[place.method]);
    advice.ranked.back().score = place.score;
    advice.ranked.back().is_in_group = place.is_in_group;
  }
  for (const Advised& one : trial.all)
    if (one.settings > 0 && one.settings < advice.settings.size()) advice.partial.push_back(one);
  return advice;
}

}  // namespace isoline::results
