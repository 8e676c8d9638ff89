// The choice of rates over a recorded grid.
#include "benchmarks/run/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/rates.h"
#include "core/json.h"
#include "core/option_json.h"
#include "core/spec.h"

namespace isoline::benchmarks {
namespace {

constexpr double kUnitSeconds = 30;
constexpr int kHitAtMillionth = 30;  // the index of τ = 1e-6 among the targets 10^(−j/5)

Real cauchy_step(const Problem& problem) {
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

constexpr const char* kNested = "network-optimizer";

// The pair's options in the tables, the tuned one set: by itself or in the network's optimizer.
OptionValues with_value(const OptimizerEntry& entry, OptionValues options,
                        const std::string& option, Real value) {
  const bool has_own = std::ranges::any_of(
      entry.options, [&](const OptionField& field) { return field.name == option; });
  const bool can_nest = std::ranges::any_of(
      entry.options, [](const OptionField& field) { return field.name == kNested; });
  if (has_own || !can_nest) {
    options.set(option, value);
    return options;
  }
  const std::string inner = parse_spec(options.text(kNested, "adam")).name;
  options.set(kNested, fmt::format("{}[{}={}]", inner == "auto" ? "adam" : inner, option, value));
  return options;
}

Real published_value(const OptionValues& options, const std::string& option) {
  if (options.contains(option)) return options.number(option, 1);
  if (!options.contains(kNested)) return 1;
  const OptionValues inner = options_of(parse_spec(options.text(kNested)));
  return inner.contains(option) ? std::stod(inner.text(option)) : 1;
}

// The unit in a process of its own; 1 where it cannot be had.
Real unit_of(const Catalog& catalog, const TuningGrid& grid, const Component& problem,
             const OptionValues& published) {
  if (grid.unit == "one") return 1;
  if (grid.unit == "published") return published_value(published, grid.option);
  const auto measured = [&] {
    return json_number(cauchy_step(make_problem(catalog, problem, 0))).dump();
  };
  const auto text = isolated_text(measured, kUnitSeconds).text;
  const Real unit = text ? real_of(parse_json(*text, "unit")) : 1;
  return std::isfinite(unit) && unit > 0 ? unit : 1;
}

// Three digits are enough of a rate, and read well.
Real rounded(Real value) {
  if (!std::isfinite(value)) return value;
  Real result = 0;
  const std::string text = fmt::format("{:.3g}", value);
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

Real median(std::vector<Real> values) {
  std::ranges::sort(values, [](Real a, Real b) { return std::isnan(b) ? !std::isnan(a) : a < b; });
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

struct Score {
  Real work = INFINITY, loss = INFINITY;
  bool operator<(const Score& other) const {
    return work != other.work ? work < other.work : loss < other.loss;
  }
};

Score score_of(const std::filesystem::path& folder, const std::vector<Request>& runs) {
  std::vector<Real> work, loss;
  for (const Request& request : runs) {
    const auto record = Store::find_in(folder, request);
    if (!record || is_failure(record->status) || record->status == Status::diverged ||
        record->status == Status::inapplicable)
      return {};
    const bool is_hit = record->hits && record->hits->work.at(kHitAtMillionth) >= 0;
    work.push_back(is_hit ? static_cast<Real>(record->hits->work[kHitAtMillionth]) : INFINITY);
    loss.push_back(record->summary.loss);
  }
  return {median(work), median(loss)};
}

// One pair: its grid of values, and the runs of each.
struct Candidate {
  std::string problem, optimizer;
  std::vector<Real> values;
  std::vector<OptionValues> options;
  std::vector<std::vector<Request>> runs;
  bool is_learned = false;
};

std::vector<Candidate> candidates_of(const Catalog& catalog, const TuningPlan& plan) {
  std::vector<Candidate> candidates;
  const Rates rates = Rates::builtin();
  for (const Component& problem : plan.problems) {
    for (const std::string& name : plan.optimizers) {
      const Rates::Row* row = rates.find(problem, name);
      const OptionValues published = row ? row->options : OptionValues();
      const Real unit = unit_of(catalog, plan.grid, problem, published);
      Candidate candidate{.problem = problem.spec, .optimizer = name};
      candidate.is_learned = problem.is_learned;
      for (const Real value : plan.grid.values) {
        candidate.values.push_back(rounded(unit * value));
        const OptionValues given = with_value(catalog.optimizers.at(name), published,
                                              plan.grid.option, candidate.values.back());
        candidate.options.push_back(given);
        std::vector<Request> runs;
        for (const std::uint64_t seed : plan.seeds)
          runs.push_back(named({.problem = problem,
                                .optimizer = complete_optimizer(catalog, name, given),
                                .seed = seed,
                                .budget = plan.budget}));
        candidate.runs.push_back(std::move(runs));
      }
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

Json rounded_all(const std::vector<Real>& values) {
  Json list = Json::array();
  for (const Real value : values) list.push_back(json_number(rounded(value)));
  return list;
}

// The row of a pair, or null where no value of the grid gave a finite loss.
Json row_of(const Candidate& candidate, const std::filesystem::path& folder,
            const std::string& option) {
  Json values = Json::array(), scores = Json::array();
  std::size_t best = 0;
  Score least;
  std::vector<Real> losses;
  for (std::size_t i = 0; i < candidate.values.size(); ++i) {
    Score score = score_of(folder, candidate.runs[i]);
    if (candidate.is_learned) score.work = INFINITY;
    losses.push_back(score.loss);
    values.push_back(candidate.values[i]);
    scores.push_back({json_number(score.work), json_number(rounded(score.loss))});
    if (score < least) {
      least = score;
      best = i;
    }
  }
  if (std::isinf(least.loss)) return nullptr;
  return {{"problem", candidate.problem},
          {"optimizer", candidate.optimizer},
          {"options", to_json(candidate.options[best])},
          {"source",
           {{"grid", {{option, values}}},
            {"score", scores},
            {"best_of", rounded_all(best_of(losses))}}}};
}

}  // namespace

TuningGrid parse_grid(const std::string& text, const std::string& unit) {
  const auto equals = text.find('='), dots = text.find(".."), cross = text.rfind('x');
  Real low = 0, high = 0;
  int count = 0;
  const auto number = [&](std::size_t from, std::size_t to, auto& value) {
    if (to == std::string::npos || from > to) return false;
    return std::from_chars(text.data() + from, text.data() + to, value).ptr == text.data() + to;
  };
  const bool is_read = equals != std::string::npos && number(equals + 1, dots, low) &&
                       number(dots + 2, cross, high) && number(cross + 1, text.size(), count);
  require(is_read && low > 0 && high >= low && count >= 1,
          [&] { return fmt::format("expected a grid such as rate=1e-4..1e-1x4, got '{}'", text); });
  TuningGrid grid{.option = text.substr(0, equals), .values = {}, .unit = unit};
  for (int i = 0; i < count; ++i)
    grid.values.push_back(low * std::pow(high / low, count > 1 ? Real(i) / (count - 1) : 0));
  return grid;
}

std::vector<Real> best_of(std::vector<Real> losses) {
  std::ranges::sort(losses);
  const auto n = losses.size();
  std::vector<Real> expected;
  for (std::size_t b = 1; b <= n; ++b) {
    // C(n − i, b − 1)/C(n, b) by its ratio from one i to the next, i = 1 … n − b + 1.
    Real weight = static_cast<Real>(b) / static_cast<Real>(n), sum = 0;
    for (std::size_t i = 1; i + b <= n + 1; ++i) {
      sum += weight * losses[i - 1];
      weight *=
          static_cast<Real>(n - i - b + 1) / static_cast<Real>(std::max<std::size_t>(1, n - i));
    }
    expected.push_back(sum);
  }
  return expected;
}

TuningResult tune(const Catalog& catalog, const TuningPlan& plan,
                  const std::filesystem::path& folder, const RunOptions& options) {
  const std::vector<Candidate> candidates = candidates_of(catalog, plan);
  std::vector<Request> requests;
  for (const Candidate& candidate : candidates)
    for (const std::vector<Request>& runs : candidate.runs)
      requests.insert(requests.end(), runs.begin(), runs.end());
  TuningResult result{.rows = std::make_shared<Json>(Json::array()),
                      .outcome = run_plan(catalog, "tuning", requests, folder, options)};
  if (result.outcome.is_interrupted) return result;
  Json rows = Json::array();
  for (const Candidate& candidate : candidates) {
    const Json row = row_of(candidate, folder, plan.grid.option);
    if (!row.is_null()) rows.push_back(row);
  }
  result.rows = std::make_shared<const Json>(std::move(rows));
  return result;
}

}  // namespace isoline::benchmarks
