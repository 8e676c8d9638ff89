// Finds the methods that were run on the same settings, and ranks them.
#include "core/results/ranking.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>

#include "core/spec.h"

namespace isoline::results {
namespace {

bool is_asked(const Comparison& c, std::size_t p, std::size_t s) {
  return c.cell(p, s).planned > 0;
}

// A setting is shared where at least two thirds of the methods were run on it, whatever their
// meanings; so a grid that is too large for many is not, and no method removes one by itself.
// Methods that apply to none of their settings do not count.
template <class Counts>
std::vector<std::size_t> shared_settings(const Comparison& c, Counts counts) {
  std::set<std::string> methods;
  for (const OptimizerAxis& axis : c.optimizers)
    if (axis.applicable > 0) methods.insert(axis.name_of_all());
  std::vector<std::size_t> shared;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    std::set<std::string> asked;
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (is_asked(c, p, s) && c.optimizers[s].applicable > 0)
        asked.insert(c.optimizers[s].name_of_all());
    if (counts(c, p) && 3 * asked.size() >= 2 * methods.size() && !asked.empty())
      shared.push_back(p);
  }
  return shared;
}

// A method is ranked that was run on every shared setting and applies to one of them; so one
// method's additional settings move no other, and none rises by what it was not run on.
template <class Counts>
Order common_order(const Comparison& c, Counts counts) {
  Order order{.settings = shared_settings(c, counts), .methods = {}};
  const auto is_applicable = [&](std::size_t p, std::size_t s) {
    return c.cell(p, s).inapplicable.empty();
  };
  for (std::size_t s = 0; s < c.optimizers.size() && !order.settings.empty(); ++s)
    if (std::ranges::all_of(order.settings, [&](std::size_t p) { return is_asked(c, p, s); }) &&
        std::ranges::any_of(order.settings, [&](std::size_t p) { return is_applicable(p, s); }))
      order.methods.push_back(s);
  return order;
}

void count_problems(OptimizerAxis& axis, const Cell& cell) {
  axis.planned += cell.planned > 0;
  axis.applicable += cell.planned > 0 && cell.inapplicable.empty();
  add_missing(axis.privileges, cell.privileges);
  axis.runs += cell.is_measured() ? cell.runs.size() : 0;
  axis.failed += cell.is_measured() ? cell.failed : 0;
}

void mark_best(Comparison& c, std::size_t p, std::size_t tolerance) {
  std::vector<Cell>& row = c.cells[p];
  const bool is_common = c.order.has_setting(p);
  Real least = kNever;
  for (std::size_t s = 0; s < row.size(); ++s)
    if (!is_common || c.order.has(s)) least = std::min(least, row[s].headline[tolerance].median);
  for (Cell& cell : row) {
    const Real mine = cell.headline[tolerance].median;
    cell.is_best[tolerance] = mine < kNever && mine <= least;
  }
}

// The optimizers, best first, those apart after all others.
std::vector<std::size_t> best_first(const Comparison& c) {
  std::vector<std::size_t> places(c.optimizers.size());
  std::iota(places.begin(), places.end(), 0);
  std::ranges::stable_sort(places, [&](std::size_t a, std::size_t b) {
    if (c.order.has(a) != c.order.has(b)) return c.order.has(a);
    const Standing &mine = c.optimizers[a].tightest(), &other = c.optimizers[b].tightest();
    if (!are_tied(mine.score, other.score)) return mine.score > other.score;
    if (mine.solved != other.solved) return mine.solved > other.solved;
    if (mine.reached != other.reached) return mine.reached > other.reached;
    return c.optimizers[a].standings[0].score > c.optimizers[b].standings[0].score;
  });
  return places;
}

// Sorts the optimizers with all that is stored by their index.
void sort_optimizers(Comparison& c, const std::vector<std::size_t>& places) {
  std::vector<std::size_t> at(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) at[places[i]] = i;
  const auto sort = [&](auto& values) {
    auto before = std::move(values);
    values.clear();
    for (const std::size_t place : places) values.push_back(std::move(before[place]));
  };
  sort(c.optimizers);
  for (auto& row : c.cells) sort(row);
  for (std::vector<Run>* runs : {&c.runs, &c.absent})
    for (Run& run : *runs) run.optimizer = at[run.optimizer];
  for (Order* order : {&c.order, &c.sanity}) {
    for (std::size_t& method : order->methods) method = at[method];
    std::ranges::sort(order->methods);
  }
}

// The rows of the order's settings; nothing for methods with extra information where these are left
// out: the others are then measured by the best of themselves.
Costs decision_costs(const Comparison& c, const Costs& all, bool is_open) {
  Costs costs;
  for (const std::size_t p : c.order.settings) {
    costs.push_back(all[p]);
    for (std::size_t s = 0; s < c.optimizers.size() && is_open; ++s)
      if (!c.optimizers[s].privileges.empty()) costs.back()[s].reset();
  }
  return costs;
}

// The result of each seed.
std::vector<Repetition> repetitions_of(const Comparison& c, std::size_t problem,
                                       const std::vector<std::optional<Real>>& costs) {
  std::map<std::uint64_t, Repetition> seeds;
  for (std::size_t s = 0; s < costs.size(); ++s)
    for (const std::size_t row : c.cell(problem, s).runs) {
      const Run& run = c.runs[row];
      Repetition& repetition = seeds[run.seed];
      repetition.seed = run.seed;
      repetition.costs.resize(costs.size());
      if (costs[s])
        repetition.costs[s] = c.taken(run, c.yardstick.by, kTightest) / least_unit(c.yardstick.by);
    }
  std::vector<Repetition> all;
  for (auto& [seed, repetition] : seeds) all.push_back(std::move(repetition));
  return all;
}

// Median costs to the tightest tolerance at these factors of the prices of one oracle, for each
// oracle that the runs called: halved, and doubled.
std::vector<OtherCosts> costs_at_other_prices(const Comparison& c) {
  std::vector<OracleCounts> counts(c.runs.size());  // until the tolerance
  OracleCounts called{};
  const std::size_t rung = c.yardstick.tightest().rung;
  for (std::size_t row = 0; row < c.runs.size(); ++row) {
    const Run& run = c.runs[row];
    if (!c.order.has(run.optimizer) || !c.order.has_setting(run.problem) ||
        run.taken(Measure::work, rung) == kNever)
      continue;
    counts[row] = counts_at(*run.record, run.taken(Measure::work, rung));
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      if (c.problems[run.problem].prices.price(*run.record, kind) > 0)
        called[kind] += counts[row][kind];
  }
  std::vector<OtherCosts> all;
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    for (const auto& [name, factor] :
         {std::pair{" at half its cost", 0.5}, std::pair{" at twice its cost", 2.0}}) {
      if (called[kind] == 0) continue;
      Costs costs(c.problems.size(), std::vector<std::optional<Real>>(c.optimizers.size()));
      for (const std::size_t p : c.order.settings)
        for (const std::size_t s : c.order.methods) {
          const auto cost = [&](std::size_t row) {
            const Run& run = c.runs[row];
            return run.taken(Measure::cost, rung) +
                   (factor - 1) * c.problems[p].prices.price(*run.record, kind) *
                       Real(counts[row][kind]);
          };
          std::vector<Real> values(c.cell(p, s).missing(), kNever);
          for (const std::size_t row : c.cell(p, s).runs) values.push_back(cost(row));
          costs[p][s] = median_of(std::move(values));
        }
      all.push_back({Varied::prices, std::string(kOracleNames[kind]) + name, std::move(costs)});
    }
  return all;
}

// Whether wall times can rank: each run was timed alone and took long enough for a clock, and for
// the first call of a library not to matter.
bool are_times_told(const Comparison& c) {
  constexpr Real kShortest = 0.05;  // seconds
  return std::ranges::all_of(c.runs, [&](const Run& run) {
    return !c.order.has(run.optimizer) || !c.order.has_setting(run.problem) ||
           run.record->status == Status::inapplicable ||
           (run.is_timed_alone && run.spent_by(Measure::time) >= kShortest);
  });
}

std::vector<OtherCosts> costs_by_other_choices(const Comparison& c) {
  const Measure own = c.yardstick.by;
  std::vector<OtherCosts> all;
  for (std::size_t t = kTightest; t-- > 0;)
    all.push_back(
        {Varied::tolerance, std::string(c.yardstick.tolerances[t].name), common_costs(c, t)});
  for (const Measure by : {Measure::work, Measure::cost, Measure::time})
    if (by != own && (by != Measure::time || are_times_told(c)))
      all.push_back({Varied::measure, std::string(name_of(by)), common_costs(c, kTightest, by)});
  std::ranges::move(costs_at_other_prices(c), std::back_inserter(all));
  return all;
}

// In a study with more runs than this, only families are resampled.
constexpr std::size_t kMostResampled = 20'000;

// Nothing where a run is missing, or where the times to rank by are not told.
std::optional<Decision> decision_of(const Comparison& c, const std::vector<OtherCosts>& others,
                                    bool is_open) {
  const auto is_ranked = [&](const Run& run) { return c.order.has_setting(run.problem); };
  if (std::ranges::any_of(c.absent, is_ranked) ||
      (c.yardstick.by == Measure::time && !are_times_told(c)))
    return std::nullopt;
  Evidence evidence{.costs = decision_costs(c, common_costs(c, kTightest), is_open)};
  for (std::size_t i = 0; i < c.order.settings.size(); ++i) {
    const std::size_t p = c.order.settings[i];
    evidence.families.push_back(c.problems[p].family());
    evidence.linear.push_back(c.problems[p].is_linear());
    if (c.runs.size() <= kMostResampled)
      evidence.repetitions.push_back(repetitions_of(c, p, evidence.costs[i]));
  }
  for (const auto& [varied, value, costs] : others)
    evidence.others.push_back({varied, value, decision_costs(c, costs, is_open)});
  return decide(evidence);
}

// The work that a run was allowed: its budget of work, or the work of all its iterations.
Real allowed_work(const Run& run) {
  const Budget& budget = run.record->request.budget;
  const Summary& summary = run.record->summary;
  Real allowed = budget.work < Budget{}.work ? Real(budget.work) : kNever;
  if (summary.iterations > 0)
    allowed = std::min(allowed, Real(summary.work) / Real(summary.iterations) *
                                    Real(std::max(budget.iterations, summary.iterations)));
  return allowed;
}

Real value_at(const Record& record, const std::vector<Real>& column, Real work) {
  const auto& spent = record.curve.work;
  auto passed = static_cast<std::size_t>(
      std::ranges::upper_bound(spent, static_cast<std::int64_t>(work)) - spent.begin());
  if (passed == spent.size() && is_failure(record.status)) return kNever;
  passed = std::min(passed, column.size());
  while (passed > 0 && !std::isfinite(column[passed - 1])) --passed;
  return passed == 0 ? kNever : column[passed - 1];
}

bool has_diverged(const Run& run) { return run.record->status == Status::diverged; }

}  // namespace

bool Order::has(std::size_t optimizer) const {
  return std::ranges::find(methods, optimizer) != methods.end();
}

bool Order::has_setting(std::size_t problem) const {
  return std::ranges::find(settings, problem) != settings.end();
}

Comparison compare_optimizers(const Study& study, const Yardstick& yardstick) {
  Comparison c{table_of(study), yardstick, {}, {}, {}, {}, {}, {}, 0};
  c.cells = pivot(c, yardstick);
  for (const auto& row : c.cells)
    for (std::size_t s = 0; s < row.size(); ++s) count_problems(c.optimizers[s], row[s]);
  c.order = common_order(c, is_ordered);
  c.sanity = common_order(c, is_sanity);
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    for (const auto& [s, standing] : standings_to(c, yardstick.by, yardstick.tolerances[t].rung))
      c.optimizers[s].standings[t] = standing;
  sort_optimizers(c, best_first(c));
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    for (std::size_t p = 0; p < c.cells.size(); ++p) mark_best(c, p, t);
    c.profiles[t] = performance_profile(common_costs(c, t));
  }
  const std::vector<OtherCosts> others = costs_by_other_choices(c);
  c.decision = decision_of(c, others, false);
  const auto is_privileged = [&](std::size_t s) { return !c.optimizers[s].privileges.empty(); };
  c.open_decision = std::ranges::any_of(c.order.methods, is_privileged)
                        ? decision_of(c, others, true)
                        : c.decision;
  std::set<std::string> names;
  for (const ProblemAxis& problem : c.problems) names.insert(problem.name);
  c.names = names.size();
  return c;
}

bool is_contrasted(const ProblemAxis& problem, bool is_noisy) {
  if (problem.aim != Aim::x || problem.is_learned || problem.is_linear() ||
      problem.is_ill_posed() || (problem.noise > 0) != is_noisy)
    return false;
  const auto options = parse_spec(problem.spec).options;
  const std::pair<std::string, std::string> by_fit("goal", "fit");
  return (std::ranges::find(options, by_fit) != options.end()) == is_noisy;
}

bool is_ordered(const Comparison& c, std::size_t p) {
  if (c.yardstick.has_contrasts) return is_contrasted(c.problems[p], false);
  if (c.problems[p].is_learned) return is_all_learned(c);
  return !is_sanity(c, p) && !is_ill_posed(c, p) && !c.problems[p].lacks_least_loss();
}

bool is_sanity(const Comparison& c, std::size_t p) {
  const auto is_run = [](const Cell& cell) { return !cell.runs.empty(); };  // else noise is unknown
  if (c.yardstick.has_contrasts)
    return c.problems[p].noise == 0 && !is_ordered(c, p) && !c.problems[p].lacks_least_loss() &&
           !c.problems[p].is_learned && std::ranges::any_of(c.cells[p], is_run);
  const auto is_in = [](const char* group) {
    return [group](const ProblemAxis& problem) { return problem.group() == group; };
  };
  return (is_in("classical")(c.problems[p]) || is_in("toy")(c.problems[p])) &&
         !c.problems[p].lacks_least_loss() && std::ranges::any_of(c.problems, is_in("physics"));
}

bool is_ill_posed(const Comparison& c, std::size_t p) {
  const ProblemAxis& problem = c.problems[p];
  if (c.yardstick.has_contrasts)
    return !problem.is_learned && problem.noise > 0 && !is_contrasted(problem, true);
  return !problem.is_learned && problem.is_ill_posed();
}

bool is_all_learned(const Comparison& c) {
  return std::ranges::all_of(c.problems, &ProblemAxis::is_learned);
}

Costs costs_to(const Comparison& c, const Order& order, Measure by, std::size_t target) {
  Costs costs(c.problems.size(), std::vector<std::optional<Real>>(c.optimizers.size()));
  for (const std::size_t p : order.settings)
    for (const std::size_t s : order.methods)
      if (is_asked(c, p, s)) costs[p][s] = c.cell(p, s).median(by, target) / least_unit(by);
  return costs;
}

Costs median_costs(const Comparison& c, std::size_t tolerance, std::optional<Measure> by) {
  Order all{.settings = std::vector<std::size_t>(c.problems.size()),
            .methods = std::vector<std::size_t>(c.optimizers.size())};
  std::iota(all.settings.begin(), all.settings.end(), 0);
  std::iota(all.methods.begin(), all.methods.end(), 0);
  return costs_to(c, all, by.value_or(c.yardstick.by), c.yardstick.tolerances[tolerance].rung);
}

Costs common_costs(const Comparison& c, std::size_t tolerance, std::optional<Measure> by) {
  return costs_to(c, c.order, by.value_or(c.yardstick.by), c.yardstick.tolerances[tolerance].rung);
}

Costs ratios_of(const Costs& costs) {
  Costs ratios;
  for (const auto& row : costs) ratios.push_back(cost_ratios(row));
  return ratios;
}

std::size_t names_of(const Comparison& c, const Order& order) {
  std::set<std::string> names;
  for (const std::size_t p : order.settings) names.insert(c.problems[p].name);
  return names.size();
}

std::size_t families_of(const Comparison& c, const Order& order) {
  std::set<std::string> families;
  for (const std::size_t p : order.settings) families.insert(c.problems[p].family());
  return families.size();
}

bool has_order(const Comparison& c) {
  constexpr std::size_t kFewFamilies = 4;
  return c.order.methods.size() > 1 && families_of(c, c.order) >= kFewFamilies;
}

Order part_of_order(const Comparison& c, bool is_linear) {
  Order part{.settings = {}, .methods = c.order.methods};
  for (const std::size_t p : c.order.settings)
    if (c.problems[p].is_linear() == is_linear) part.settings.push_back(p);
  return part;
}

bool are_tied(Real score, Real other) {
  constexpr Real kRounding = 1e-12;  // sums of the same scores in another order
  return std::abs(score - other) <= kRounding;
}

bool are_tied(const Standing& standing, const Standing& other) {
  return are_tied(standing.score, other.score) && standing.solved == other.solved;
}

std::vector<Ranked> standings_to(const Comparison& c, Measure by, std::size_t target) {
  return standings_over(c, c.order, by, target);
}

std::vector<Ranked> standings_over(const Comparison& c, const Order& order, Measure by,
                                   std::size_t target) {
  const Costs costs = costs_to(c, order, by, target), ratios = ratios_of(costs);
  Costs rows;
  std::vector<std::string> families;
  for (const std::size_t p : order.settings) {
    rows.push_back(costs[p]);
    families.push_back(c.problems[p].family());
  }
  const std::vector<Real> scores = mean_scores(family_scores(rows, families, order.methods));
  std::vector<Ranked> standings;
  for (const std::size_t s : order.methods) {
    Standing standing{.settings = order.settings.size()};
    if (!scores.empty()) standing.score = scores[standings.size()];
    std::vector<Real> doublings;
    for (const std::size_t p : order.settings) {
      const Real ratio = *ratios[p][s];
      standing.solved += ratio < kNever;
      standing.wins += std::ranges::all_of(costs[p], [&](const std::optional<Real>& other) {
        return ratio < kNever && (!other || *costs[p][s] <= *other);
      });
      doublings.push_back(std::log2(ratio));
      const Cell& cell = c.cell(p, s);
      if (!cell.is_measured()) continue;
      const auto has_met = [&](const Run& run) { return run.returned_met > target; };
      standing.runs += cell.runs.size();
      standing.reached += c.where(cell.runs, has_met).size();
    }
    standing.typical = std::exp2(median_of(std::move(doublings)));
    standings.push_back({s, standing});
  }
  std::ranges::stable_sort(standings, [](const Ranked& a, const Ranked& b) {
    if (!are_tied(a.standing.score, b.standing.score)) return a.standing.score > b.standing.score;
    if (a.standing.solved != b.standing.solved) return a.standing.solved > b.standing.solved;
    return a.standing.reached > b.standing.reached;
  });
  return standings;
}

Spread x_error_at(const Comparison& c, std::size_t p, std::size_t s, Real share) {
  const auto error = [&](const Run& run) {
    return value_at(*run.record, run.record->curve.x_error, share * allowed_work(run)) /
           run.record->x_scale.value_or(1);
  };
  const Cell& cell = c.cell(p, s);
  return cell.is_measured() ? c.aggregate(cell.runs, error, cell.missing()) : Spread{};
}

Spread own_time(const Comparison& c, std::size_t s) {
  constexpr Real kLeast = 1e-3;  // seconds: shorter runs are mostly what starts and ends them
  std::vector<Real> shares;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (const std::size_t row : c.cell(p, s).runs) {
      const Record& record = *c.runs[row].record;
      const Real spent = record.summary.processor_seconds;
      const std::optional<Real> oracles = c.problems[p].prices.seconds(record);
      if (oracles && spent >= kLeast) shares.push_back(std::max(0.0, 1 - *oracles / spent));
    }
  return spread_of(std::move(shares));
}

// Reads learned runs where all have spent the same.

std::vector<std::size_t> EqualWork::nearest_first() const {
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < methods.size(); ++s)
    if (methods[s]) order.push_back(s);
  std::ranges::stable_sort(order, {}, [&](std::size_t s) { return methods[s]->x_error.median; });
  return order;
}

EqualWork equal_work(const Comparison& c, std::size_t problem) {
  EqualWork all{.work = kNever, .methods = {}};
  for (const Cell& cell : c.cells[problem])
    if (cell.is_measured())
      all.work = std::min(all.work, c.aggregate(cell.runs, allowed_work).median);
  for (const Cell& cell : c.cells[problem]) {
    const auto at = [&](std::vector<Real> Curve::*column) {
      return c.aggregate(cell.runs, [&](const Run& run) {
        return value_at(*run.record, run.record->curve.*column, all.work);
      });
    };
    all.methods.emplace_back();
    if (!cell.is_measured()) continue;
    AtEqualWork& own = all.methods.back().emplace(AtEqualWork{
        at(&Curve::x_error), at(&Curve::loss), c.where(cell.runs, has_diverged).size(), {}});
    for (const std::size_t row : cell.runs)
      own.errors[c.runs[row].seed] =
          value_at(*c.runs[row].record, c.runs[row].record->curve.x_error, all.work);
  }
  return all;
}

TimesLarger times_larger(const AtEqualWork& first, const AtEqualWork& second) {
  TimesLarger out{.times = second.x_error.median / first.x_error.median, .interval = {}};
  std::vector<Real> logarithms;
  for (const auto& [seed, error] : first.errors)
    if (const auto other = second.errors.find(seed); other != second.errors.end()) {
      logarithms.push_back(std::log(other->second / error));
      out.larger += other->second > error;
    }
  out.seeds = logarithms.size();
  if (out.seeds < 2 ||
      !std::ranges::all_of(logarithms, [](Real value) { return std::isfinite(value); }))
    return out;
  const Real n = static_cast<Real>(out.seeds);
  const Real mean = std::accumulate(logarithms.begin(), logarithms.end(), 0.0) / n;
  auto [low, high] = std::ranges::minmax(logarithms);
  if (!out.is_range()) {
    constexpr Real kTwoSided = 0.975;
    const Real half =
        student_quantile(kTwoSided, out.seeds - 1) * deviation_of(logarithms) / std::sqrt(n);
    low = mean - half;
    high = mean + half;
  }
  out.times = std::exp(mean);
  out.interval = {std::exp(low), std::exp(high)};
  return out;
}

std::vector<std::size_t> ranking(const Comparison& c, std::size_t problem) {
  if (c.problems[problem].is_learned) return equal_work(c, problem).nearest_first();
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (c.cell(problem, s).is_measured()) order.push_back(s);
  std::ranges::stable_sort(order, {}, [&](std::size_t s) {
    const Cell& cell = c.cell(problem, s);
    return std::array{cell.headline[2].median, cell.headline[1].median, cell.headline[0].median,
                      cell.loss.median};
  });
  return order;
}

}  // namespace isoline::results
