// The tuned option of a method: its values and their unit, their scores, and the choice.
#include "benchmarks/run/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/run/isolate.h"
#include "core/json.h"
#include "core/options.h"
#include "core/results/decisions.h"
#include "core/status.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks {

using optimizers::Tunable;
namespace {

constexpr const char* kNested = "network-optimizer";

const OptionField* field_of(const OptimizerEntry& entry, const std::string& option) {
  const auto at = std::ranges::find(entry.options, option, &OptionField::name);
  return at == entry.options.end() ? nullptr : &*at;
}

Knob knob_of_field(const OptimizerEntry& entry, const OptionField& field) {
  const Index* const whole = std::get_if<Index>(&field.standard);
  const Real* const number = std::get_if<Real>(&field.standard);
  return {.option = field.name,
          .standard = whole    ? static_cast<Real>(*whole)
                      : number ? *number
                               : 1,
          .range = field.range,
          .is_whole = whole != nullptr,
          .tunable = entry.tunable};
}

// The rate of the gradient rule inside: what is given, or what network-optimizer=auto stands for.
Knob knob_inside(const Catalog& catalog, const OptimizerEntry& outer, const Component& problem,
                 const OptionValues& given) {
  const Spec inner = parse_spec(given.text(kNested, "auto"));
  const bool is_automatic = inner.name == "auto";
  const std::string rule = !is_automatic ? inner.name : problem.is_learned ? "adam" : "gd";
  const OptimizerEntry& entry = catalog.optimizers.at(rule);
  const OptionField* field = field_of(entry, "rate");
  require(field != nullptr, [&] { return fmt::format("{} does not have a rate to tune", rule); });
  Knob knob = knob_of_field(entry, *field);
  knob.rule = rule;
  const OptionValues options = options_of(inner);
  if (options.contains("rate")) knob.standard = std::stod(options.text("rate"));
  if (is_automatic && !problem.is_learned) {  // gd[rate=1]: a unit of its own, not the loss's
    knob.standard = 1;
    knob.tunable = outer.tunable;
  }
  return knob;
}

// For an option that is named; UsageError where the method has no such number.
Knob knob_named(const Catalog& catalog, const std::string& optimizer, const Component& problem,
                const OptionValues& given, const std::string& option) {
  const OptimizerEntry entry = entry_of(catalog, optimizer, given);
  const OptionField* field = field_of(entry, option);
  if (!field && option == "rate" && field_of(entry, kNested))
    return knob_inside(catalog, entry, problem, given);
  const bool is_number = field && !std::holds_alternative<bool>(field->standard) &&
                         !std::holds_alternative<std::string>(field->standard);
  require(is_number, [&] {
    return fmt::format("{} does not have an option {} that is a number", optimizer, option);
  });
  Knob knob = knob_of_field(entry, *field);
  knob.standard = given.number(option, knob.standard);
  return knob;
}

Real three_digits(Real value) {  // enough of a rate, and they read well
  Real result = 0;
  const std::string text = fmt::format("{:.3g}", value);
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

std::optional<Real> allowed(const Knob& knob, Real value) {
  value = knob.is_whole ? std::round(value) : three_digits(value);
  return value > 0 && contains(knob.range, value) ? std::optional(value) : std::nullopt;
}

Real measured_cauchy_step(const Problem& problem) {
  Point point;
  problem.forward(problem.start(), point);
  Matrix g(problem.outputs(), problem.samples()), pushed(problem.outputs(), problem.samples());
  Matrix curved(problem.outputs(), problem.samples());
  Vector gradient(problem.unknowns());
  problem.cotangent(point, g);
  problem.pullback(g, gradient, point);
  problem.pushforward(gradient, pushed, point);
  problem.loss_curvature(point, pushed, curved);
  return gradient.squaredNorm() / pushed.cwiseProduct(curved).sum();
}

// ‖∇L‖²/‖J∇L‖² at the problem's start, in a process of its own; 1 where it cannot be had.
Real cauchy_step(const Catalog& catalog, const Component& problem) {
  constexpr double kSeconds = 30;
  const auto measured = [&] {
    return json_text(json_number(measured_cauchy_step(make_problem(catalog, problem, 0))));
  };
  const auto text = isolated_text(measured, kSeconds).text;
  const Real step = text ? real_of(parse_json(*text, "Cauchy step")) : 1;
  return std::isfinite(step) && step > 0 ? step : 1;
}

// --- scores, read off records

Real median(std::vector<Real> values) {
  std::ranges::sort(values, [](Real a, Real b) { return std::isnan(b) ? !std::isnan(a) : a < b; });
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// Until solved in x, of learned runs at stored iterations, or in loss; infinite if neither.
Real work_of(const Record& run) {
  const std::size_t target = rung_of(1e-6);
  const std::optional<Hits>& hits = run.aim == Aim::loss ? run.hits : run.x_hits;
  if (hits || run.aim == Aim::loss) {
    const bool is_hit = hits && hits->work.at(target) >= 0;
    return is_hit ? static_cast<Real>(hits->work[target]) : INFINITY;
  }
  if (!run.x_scale) return INFINITY;
  const Real goal = x_goal(rung(target), *run.x_scale, run.x_floor);
  for (std::size_t i = 0; i < run.curve.x_error.size(); ++i)
    if (run.curve.x_error[i] <= goal) return static_cast<Real>(run.curve.work[i]);
  return INFINITY;
}

// --- the choice of one option over a recorded grid

struct Candidate {
  TunedPair pair;
  Knob knob;
  TunedOption tuned = {};
  std::vector<std::vector<Request>> runs = {};  // of each value; none: it is new
  bool may_grow = false, is_inapplicable = false;
  int below = 0, above = 0;  // values added at either edge
};

OptionValues options_at(const Candidate& candidate, Real value) {
  return with_value(candidate.knob, candidate.pair.options, value);
}

void add_value(Candidate& candidate, std::size_t place, Real value) {
  const auto at = static_cast<std::ptrdiff_t>(place);
  TunedOption& tuned = candidate.tuned;
  tuned.values.insert(tuned.values.begin() + at, value);
  tuned.scores.insert(tuned.scores.begin() + at, TuningScore());
  candidate.runs.emplace(candidate.runs.begin() + at);
}

Candidate candidate_of(const Catalog& catalog, const TunedPair& pair, const TuningPlan& plan) {
  std::optional<Knob> knob;
  std::vector<Real> values;
  if (const auto& grid = plan.grid) {
    knob = knob_named(catalog, pair.optimizer, pair.problem, pair.options, grid->option);
    Real unit = grid->unit == "published" ? knob->standard : 1;
    if (grid->unit == "cauchy") unit = cauchy_step(catalog, pair.problem);
    for (const Real each : grid->values)
      values.push_back(knob->is_whole ? std::round(unit * each) : three_digits(unit * each));
  } else {
    knob = knob_of(catalog, pair.optimizer, pair.problem, pair.options);
    require(knob.has_value(), [&] { return pair.optimizer + " does not have an option to tune"; });
    const bool in_cauchy_steps = knob->tunable.unit == Tunable::Unit::cauchy && !plan.is_common;
    values = plan.is_common    ? common_grid_of(*knob)
             : in_cauchy_steps ? grid_of(*knob, cauchy_step(catalog, pair.problem))
                               : grid_of(*knob, knob->standard);
  }
  Candidate candidate{.pair = pair, .knob = *knob, .may_grow = !plan.grid && !plan.is_common};
  candidate.tuned.family = family_of(catalog.problems.at(pair.problem.name));
  candidate.tuned.standard = knob->standard;
  candidate.tuned.problem = pair.problem.spec;
  candidate.tuned.optimizer = pair.optimizer;
  candidate.tuned.option = knob->option + (knob->rule.empty() ? "" : " of " + knob->rule);
  for (std::size_t i = 0; i < values.size(); ++i) add_value(candidate, i, values[i]);
  return candidate;
}

// The runs of the values that have none yet.
void add_runs(const Catalog& catalog, const TuningPlan& plan, Candidate& candidate,
              std::vector<Request>& all) {
  const TunedPair& pair = candidate.pair;
  for (std::size_t i = 0; i < candidate.runs.size(); ++i) {
    std::vector<Request>& runs = candidate.runs[i];
    if (!runs.empty()) continue;
    const OptionValues options = options_at(candidate, candidate.tuned.values[i]);
    const Component optimizer = complete_optimizer(catalog, pair.optimizer, options);
    for (const std::uint64_t seed : plan.seeds)
      runs.push_back(named(
          {.problem = pair.problem, .optimizer = optimizer, .seed = seed, .budget = pair.budget}));
    all.insert(all.end(), runs.begin(), runs.end());
  }
}

// Whether the best stands at an edge; after a tie with its neighbour, no further value is tried.
bool is_better_edge(const std::vector<TuningScore>& scores, std::size_t best) {
  const std::size_t last = scores.size() - 1;
  const bool is_last = best == last, is_outermost = best == 0 || is_last;
  return last > 0 && is_outermost && scores[best] < scores[is_last ? last - 1 : 1];
}

void judge(const std::filesystem::path& folder, Candidate& candidate) {
  TunedOption& tuned = candidate.tuned;
  tuned.work = 0;
  for (std::size_t i = 0; i < tuned.values.size(); ++i) {
    std::vector<Record> records;
    for (const Request& request : candidate.runs[i])
      if (auto record = Store::find_in(folder, request)) records.push_back(std::move(*record));
    candidate.is_inapplicable |= std::ranges::any_of(
        records, [](const Record& record) { return record.status == Status::inapplicable; });
    for (const Record& record : records) tuned.work += record.summary.work;
    const bool is_whole = records.size() == candidate.runs[i].size();
    tuned.scores[i] = is_whole ? score_of(records) : TuningScore();
  }
  tuned.best = best_value(tuned.values, tuned.scores, candidate.knob.standard);
  tuned.is_at_edge = is_better_edge(tuned.scores, tuned.best);
}

// One more value beyond the edge that the best stands at; whether there may be one.
bool grow(Candidate& candidate) {
  const TunedOption& tuned = candidate.tuned;
  if (!candidate.may_grow || candidate.is_inapplicable || !tuned.is_at_edge) return false;
  const bool upward = tuned.best > 0;
  int& added = upward ? candidate.above : candidate.below;
  const auto value = value_beyond(candidate.knob, tuned.values, upward);
  if (!value || added == kMostExtensions) return false;
  ++added;
  add_value(candidate, upward ? tuned.values.size() : 0, *value);
  return true;
}

Json candidate_row(const Candidate& candidate, const Budget& usual) {
  const auto number_of = [](Real value) {
    return std::isfinite(value) ? Json(three_digits(value)) : json_number(value);
  };
  const TunedOption& tuned = candidate.tuned;
  Json scores = Json::array();
  for (const TuningScore& score : tuned.scores)
    scores.push_back({json_number(score.work), number_of(score.left)});
  Json source{{"grid", {{candidate.knob.option, tuned.values}}},
              {"score", scores},
              {"default", tuned.standard},
              {"value", tuned.values[tuned.best]},
              {"spent", tuned.work}};
  if (tuned.is_at_edge) source["edge"] = true;
  const Budget& budget = candidate.pair.budget;
  if (budget.work != usual.work) source["work"] = budget.work;
  return {{"problem", tuned.problem},
          {"optimizer", tuned.optimizer},
          {"options", to_json(options_at(candidate, tuned.values[tuned.best]))},
          {"source", source}};
}

// One row per method and problem, which is for all settings of the problem.
Json left_out_rows(const std::vector<Candidate>& candidates,
                   const std::vector<TunedOption>& tuned) {
  Json rows = Json::array();
  for (const LeftOut& left : leave_one_out(tuned)) {
    const auto candidate =
        std::ranges::find(candidates, left.grid->optimizer,
                          [](const Candidate& each) { return each.pair.optimizer; });
    Json scores = Json::array();
    for (const Real score : left.scores) scores.push_back(three_digits(score));
    Json source{{"grid", {{candidate->knob.option, left.grid->values}}},
                {"mean_score", scores},
                {"families", left.chosen_on},
                {"default", left.grid->standard},
                {"value", left.grid->values[left.best]},
                {"spent", left.work}};
    if (left.is_at_edge) source["edge"] = true;
    std::set<std::string> problems;
    for (const Candidate& each : candidates)
      if (each.tuned.family == left.family) problems.insert(each.pair.problem.name);
    for (const std::string& problem : problems)
      rows.push_back({{"problem", problem},
                      {"optimizer", left.grid->optimizer},
                      {"options", to_json(options_at(*candidate, left.grid->values[left.best]))},
                      {"source", source}});
  }
  return rows;
}

// The score of each value of a grid on its setting; all 0 where none solves it.
std::vector<Real> setting_scores(const TunedOption& tuned) {
  std::vector<std::optional<Real>> work;
  for (const TuningScore& score : tuned.scores) work.emplace_back(score.work);
  std::vector<Real> scores;
  for (const auto& ratio : results::cost_ratios(work))
    scores.push_back(results::score_of(*ratio, results::kProfileEnd));
  return scores;
}

std::vector<Real> mean_of(const std::vector<std::vector<Real>>& rows, std::size_t columns) {
  std::vector<Real> mean(columns, 0);
  for (const std::vector<Real>& row : rows)
    for (std::size_t i = 0; i < columns; ++i) mean[i] += row[i] / static_cast<Real>(rows.size());
  return mean;
}

}  // namespace

std::optional<Knob> knob_of(const Catalog& catalog, const std::string& optimizer,
                            const Component& problem, const OptionValues& given) {
  const OptimizerEntry entry = entry_of(catalog, optimizer, given);
  const Tunable& tunable = entry.tunable;
  if (tunable.option.empty()) return std::nullopt;
  const bool trains = problem.is_learned && field_of(entry, kNested);
  if (trains || tunable.option == kNested) return knob_inside(catalog, entry, problem, given);
  return knob_named(catalog, optimizer, problem, given, tunable.option);
}

OptionValues with_value(const Knob& knob, OptionValues given, Real value) {
  if (knob.is_whole)
    given.set(knob.option, static_cast<Index>(std::round(value)));
  else if (knob.rule.empty())
    given.set(knob.option, value);
  else
    given.set(kNested, fmt::format("{}[{}={}]", knob.rule, knob.option, value));
  return given;
}

std::vector<Real> grid_of(const Knob& knob, Real unit) {
  std::vector<Real> values;
  for (int i = 0; i < kGridValues; ++i) {
    const Real value = unit * std::pow(knob.tunable.factor, i - knob.tunable.below);
    if (const auto each = allowed(knob, value)) values.push_back(*each);
  }
  if (values.empty()) return {knob.standard};
  if (knob.standard < values.front() || knob.standard > values.back()) return values;
  *std::ranges::min_element(values, {}, [&](Real value) {
    return std::abs(std::log(value / knob.standard));
  }) = knob.standard;
  return values;
}

std::vector<Real> common_grid_of(const Knob& knob) {
  constexpr int kFewestBelow = 2;
  Knob wide = knob;
  wide.tunable.below = std::max(kFewestBelow, knob.tunable.below);
  wide.tunable.factor *= knob.tunable.factor;
  return grid_of(wide, knob.standard);
}

std::optional<Real> value_beyond(const Knob& knob, const std::vector<Real>& values, bool upward) {
  const Real two = std::pow(knob.tunable.factor, 2);  // from the last but one: less is rounded
  const std::size_t next = values.size() > 1 ? 1 : 0;
  const Real value = upward ? values[values.size() - 1 - next] * two : values[next] / two;
  const auto each = allowed(knob, value);
  return each && *each != values.front() && *each != values.back() ? each : std::nullopt;
}

GivenGrid parse_grid(const std::string& text, const std::string& unit) {
  const auto equals = text.find('='), dots = text.find(".."), cross = text.rfind('x');
  Real low = 0, high = 0;
  int count = 0;
  const auto number = [&](std::size_t from, std::size_t to, auto& value) {
    if (to == std::string::npos || from > to) return false;
    return std::from_chars(text.data() + from, text.data() + to, value).ptr == text.data() + to;
  };
  const bool is_read = equals != std::string::npos && number(equals + 1, dots, low) &&
                       number(dots + 2, cross, high) && number(cross + 1, text.size(), count);
  constexpr int kMost = 1000;
  const bool is_grid = is_read && low > 0 && high >= low && std::isfinite(high) && count >= 1;
  require(is_grid, [&] {
    return fmt::format("--grid must have a form such as rate=1e-4..1e-1x4, got '{}'", text);
  });
  require(count <= kMost,
          [&] { return fmt::format("--grid must have at most 1,000 values, got '{}'", text); });
  GivenGrid grid{.option = text.substr(0, equals), .values = {}, .unit = unit};
  for (int i = 0; i < count; ++i)
    grid.values.push_back(low * std::pow(high / low, count > 1 ? Real(i) / (count - 1) : 0));
  return grid;
}

TuningScore score_of(const std::vector<Record>& runs) {
  std::vector<Real> work, left;
  for (const Record& run : runs) {
    if (is_failure(run.status) || run.status == Status::diverged ||
        run.status == Status::inapplicable)
      return {};
    const Real end = run.aim == Aim::x ? run.summary.x_error : run.summary.loss;
    work.push_back(run.request.problem.is_learned ? INFINITY : work_of(run));
    left.push_back(std::isnan(end) ? INFINITY : end);
  }
  if (runs.empty()) return {};
  return {median(work), median(left)};
}

std::size_t best_value(const std::vector<Real>& values, const std::vector<TuningScore>& scores,
                       Real standard) {
  const auto away = [&](std::size_t i) { return std::abs(std::log(values[i] / standard)); };
  std::size_t best = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (scores[i] < scores[best] || (scores[i] == scores[best] && away(i) < away(best))) best = i;
  return best;
}

std::vector<LeftOut> leave_one_out(const std::vector<TunedOption>& tuned) {
  using Scores = std::vector<std::vector<Real>>;  // a row per setting, a column per value
  struct Method {
    const TunedOption* grid = nullptr;
    std::map<std::string, Scores> families;
    std::int64_t work = 0;
  };
  std::map<std::string, Method> methods;
  std::set<std::string> families;
  for (const TunedOption& each : tuned) {
    Method& method = methods[each.optimizer];
    if (!method.grid) method.grid = &each;
    require(method.grid->values == each.values,
            [&] { return each.optimizer + " has other values on " + each.problem; });
    method.families[each.family].push_back(setting_scores(each));
    method.work += each.work;
    families.insert(each.family);
  }
  std::vector<LeftOut> all;
  for (const auto& [name, method] : methods)
    for (const std::string& family : families) {
      const std::size_t values = method.grid->values.size();
      LeftOut left{.family = family, .grid = method.grid, .work = method.work};
      Scores means;
      for (const auto& [other, scores] : method.families) {
        if (other == family) continue;
        left.chosen_on.push_back(other);
        means.push_back(mean_of(scores, values));
      }
      left.scores = mean_of(means, values);
      std::vector<TuningScore> ordered;  // less is better; rounded, or sums would break ties
      for (const Real score : left.scores) ordered.push_back({.work = -three_digits(score)});
      left.best = best_value(method.grid->values, ordered, method.grid->standard);
      left.is_at_edge = is_better_edge(ordered, left.best);
      all.push_back(std::move(left));
    }
  return all;
}

TuningResult tune(const Catalog& catalog, const TuningPlan& plan,
                  const std::filesystem::path& folder, const RunOptions& options) {
  std::vector<Candidate> candidates;
  for (const TunedPair& pair : plan.pairs) candidates.push_back(candidate_of(catalog, pair, plan));
  std::vector<Candidate*> open;  // those with new values
  for (Candidate& candidate : candidates) open.push_back(&candidate);
  TuningResult result{.rows = std::make_shared<Json>(Json::array()),
                      .left_out_rows = std::make_shared<Json>(Json::array()),
                      .tuned = {},
                      .outcome = {}};
  while (!open.empty()) {
    std::vector<Request> requests;
    for (Candidate* candidate : open) add_runs(catalog, plan, *candidate, requests);
    Outcome round = run_plan(catalog, "tuning", requests, folder, options);
    round.run += result.outcome.run;
    round.seconds += result.outcome.seconds;
    result.outcome = std::move(round);
    if (result.outcome.is_interrupted) return result;
    for (Candidate* candidate : open) judge(folder, *candidate);
    std::erase_if(open, [](Candidate* candidate) { return !grow(*candidate); });
  }
  Json rows = Json::array();
  for (const Candidate& candidate : candidates) {
    result.inapplicable += candidate.is_inapplicable;
    if (candidate.is_inapplicable) continue;
    rows.push_back(candidate_row(candidate, plan.pairs[0].budget));
    result.tuned.push_back(candidate.tuned);
  }
  result.rows = std::make_shared<const Json>(std::move(rows));
  if (plan.is_common)
    result.left_out_rows = std::make_shared<const Json>(left_out_rows(candidates, result.tuned));
  return result;
}

}  // namespace isoline::benchmarks
