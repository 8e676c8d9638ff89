// The choice of one option over a recorded grid.
#include "benchmarks/run/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/options.h"

namespace isoline::benchmarks {

using optimizers::Tunable;
namespace {

struct Trial {
  Real value = 0;
  std::vector<Request> runs = {};
  std::optional<TuningScore> score = {};
};

// One pair: its grid of values, ascending, and what each came to.
struct Candidate {
  TunedPair pair;
  Knob knob;
  std::vector<Trial> trials = {};
  bool may_grow = false, is_inapplicable = false;
  int below = 0, above = 0;  // values added at either edge

  std::vector<Real> values() const {
    std::vector<Real> all;
    for (const Trial& trial : trials) all.push_back(trial.value);
    return all;
  }
  std::vector<TuningScore> scores() const {
    std::vector<TuningScore> all;
    for (const Trial& trial : trials) all.push_back(trial.score.value_or(TuningScore{}));
    return all;
  }
  std::size_t best() const { return best_value(values(), scores(), knob.standard); }
  // The best stands at an edge, and better than its neighbour: a tie asks for nothing beyond.
  bool is_at_edge() const {
    const std::size_t i = best(), last = trials.size() - 1;
    if (last == 0 || (i > 0 && i < last)) return false;
    const std::vector<TuningScore> all = scores();
    return all[i] < all[i == 0 ? 1 : last - 1];
  }
};

Candidate candidate_of(const Catalog& catalog, const TunedPair& pair, const TuningPlan& plan) {
  Candidate candidate{.pair = pair};
  std::vector<Real> values;
  if (const auto& grid = plan.grid) {
    candidate.knob = knob_named(catalog, pair.optimizer, pair.problem, pair.options, grid->option);
    Real unit = grid->unit == "published" ? candidate.knob.standard : 1;
    if (grid->unit == "cauchy") unit = cauchy_step(catalog, pair.problem);
    values = values_of(candidate.knob, *grid, unit);
  } else {
    const auto knob = knob_of(catalog, pair.optimizer, pair.problem, pair.options);
    require(knob.has_value(), [&] { return pair.optimizer + " has nothing to tune"; });
    const bool in_cauchy_steps = knob->tunable.unit == Tunable::Unit::cauchy;
    candidate.knob = *knob;
    candidate.may_grow = true;
    values = grid_of(*knob, in_cauchy_steps ? cauchy_step(catalog, pair.problem) : knob->standard);
  }
  for (const Real value : values) candidate.trials.push_back({.value = value});
  return candidate;
}

OptionValues options_at(const Candidate& candidate, Real value) {
  return with_value(candidate.knob, candidate.pair.options, value);
}

// The runs of the values that have none yet.
void add_runs(const Catalog& catalog, const TuningPlan& plan, Candidate& candidate,
              std::vector<Request>& all) {
  const TunedPair& pair = candidate.pair;
  for (Trial& trial : candidate.trials) {
    if (!trial.runs.empty()) continue;
    const Component optimizer =
        complete_optimizer(catalog, pair.optimizer, options_at(candidate, trial.value));
    for (const std::uint64_t seed : plan.seeds)
      trial.runs.push_back(named(
          {.problem = pair.problem, .optimizer = optimizer, .seed = seed, .budget = pair.budget}));
    all.insert(all.end(), trial.runs.begin(), trial.runs.end());
  }
}

void judge(const std::filesystem::path& folder, Candidate& candidate) {
  for (Trial& trial : candidate.trials) {
    if (trial.score) continue;
    std::vector<Record> records;
    for (const Request& request : trial.runs)
      if (auto record = Store::find_in(folder, request)) records.push_back(std::move(*record));
    candidate.is_inapplicable |= std::ranges::any_of(
        records, [](const Record& record) { return record.status == Status::inapplicable; });
    const bool is_whole = records.size() == trial.runs.size();
    trial.score = is_whole ? score_of(records) : TuningScore{};
  }
}

// One more value beyond the edge that the best stands at, where there may be one.
void grow(Candidate& candidate) {
  if (!candidate.may_grow || candidate.is_inapplicable || !candidate.is_at_edge()) return;
  const bool upward = candidate.best() > 0;
  int& added = upward ? candidate.above : candidate.below;
  const auto value = value_beyond(candidate.knob, candidate.values(), upward);
  if (!value || added == kMostExtensions) return;
  ++added;
  auto& trials = candidate.trials;
  trials.insert(upward ? trials.end() : trials.begin(), {.value = *value});
}

Json number_of(Real value) {
  return std::isfinite(value) ? Json(three_digits(value)) : json_number(value);
}

Json row_of(const Candidate& candidate, const Budget& usual) {
  Json values = Json::array(), scores = Json::array(), expected = Json::array();
  std::vector<Real> left;
  for (const Trial& trial : candidate.trials) {
    const TuningScore score = trial.score.value_or(TuningScore{});
    left.push_back(score.left);
    values.push_back(trial.value);
    scores.push_back({json_number(score.work), number_of(score.left)});
  }
  for (const Real each : best_of(left)) expected.push_back(number_of(each));
  const Real chosen = candidate.trials[candidate.best()].value;
  Json source{
      {"grid", {{candidate.knob.option, values}}}, {"score", scores}, {"best_of", expected}};
  if (candidate.is_at_edge()) source["edge"] = true;
  const Budget& budget = candidate.pair.budget;
  if (budget.work != usual.work) source["work"] = budget.work;
  return {{"problem", candidate.pair.problem.spec},
          {"optimizer", candidate.pair.optimizer},
          {"options", to_json(options_at(candidate, chosen))},
          {"source", source}};
}

TunedOption tuned_of(const Candidate& candidate) {
  const Knob& knob = candidate.knob;
  return {.problem = candidate.pair.problem.spec,
          .optimizer = candidate.pair.optimizer,
          .option = knob.rule.empty() ? knob.option : knob.option + " of " + knob.rule,
          .values = candidate.values(),
          .scores = candidate.scores(),
          .best = candidate.best(),
          .is_at_edge = candidate.is_at_edge()};
}

void add_round(TuningResult& result, Outcome round) {
  round.run += result.outcome.run;
  round.seconds += result.outcome.seconds;
  result.outcome = std::move(round);
}

}  // namespace

TuningResult tune(const Catalog& catalog, const TuningPlan& plan,
                  const std::filesystem::path& folder, const RunOptions& options) {
  std::vector<Candidate> candidates;
  for (const TunedPair& pair : plan.pairs) candidates.push_back(candidate_of(catalog, pair, plan));
  TuningResult result{.rows = std::make_shared<Json>(Json::array()), .tuned = {}, .outcome = {}};
  while (true) {
    std::vector<Request> requests;
    for (Candidate& candidate : candidates) add_runs(catalog, plan, candidate, requests);
    if (requests.empty()) break;
    add_round(result, run_plan(catalog, "tuning", requests, folder, options));
    if (result.outcome.is_interrupted) return result;
    for (Candidate& candidate : candidates) {
      judge(folder, candidate);
      grow(candidate);
    }
  }
  Json rows = Json::array();
  for (const Candidate& candidate : candidates) {
    result.inapplicable += candidate.is_inapplicable;
    if (candidate.is_inapplicable) continue;
    rows.push_back(row_of(candidate, plan.pairs[0].budget));
    result.tuned.push_back(tuned_of(candidate));
  }
  result.rows = std::make_shared<const Json>(std::move(rows));
  return result;
}

}  // namespace isoline::benchmarks
