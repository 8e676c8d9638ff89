// Settings with noise, bounds and other features beside the same settings without: how far the
// ranking moves, the error at the noise level beside the best error of a run, and the error over
// the noise.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/options.h"
#include "core/results/statistics.h"
#include "reports/sections/drawings.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// A setting that has all options of another one of its problem, and more.
struct Featured {
  std::size_t problem, plain;
  std::string feature;  // "noise=0.01"
  Real noise = 0;       // where the feature is nothing else
};

// The part of `whole` beyond `part`, if it has all of that.
std::optional<OptionValues> rest_of(const OptionValues& whole, const OptionValues& part) {
  OptionValues rest = whole;
  for (const auto& [name, value] : part) {
    const OptionValue* has = whole.find(name);
    if (has == nullptr || *has != value) return std::nullopt;
    rest.erase(name);
  }
  if (rest.empty()) return std::nullopt;
  return rest;
}

std::vector<Featured> featured_settings(const Comparison& c) {
  std::vector<Featured> all;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const OptionValues* mine = options_of(c, p);
    std::optional<OptionValues> most;  // the plainest setting leaves the most
    std::size_t plain = 0;
    for (std::size_t q = 0; mine != nullptr && q < c.problems.size(); ++q) {
      const OptionValues* other = options_of(c, q);
      if (c.problems[q].name != c.problems[p].name || other == nullptr) continue;
      auto rest = rest_of(*mine, *other);
      if (!rest || (most && rest->size() <= most->size())) continue;
      most = std::move(rest);
      plain = q;
    }
    if (!most) continue;
    Featured found{.problem = p, .plain = plain, .feature = ""};
    for (const auto& [name, value] : *most)
      found.feature += (found.feature.empty() ? "" : ",") + name + "=" + option_text(value);
    if (most->size() == 1) found.noise = most->number("noise", 0);
    all.push_back(std::move(found));
  }
  return all;
}

bool is_rankable(const Comparison& c, std::size_t p) {
  return !c.problems[p].is_learned && !c.problems[p].is_ill_posed() &&
         !c.problems[p].lacks_least_loss();
}

// The scores of the same methods on the settings with a feature, and on those without.
struct Move {
  std::vector<Ranked> with, without;  // best first
  Real correlation = 0;

  std::size_t place_without(std::size_t optimizer) const {
    return 1 + static_cast<std::size_t>(std::ranges::find(without, optimizer, &Ranked::optimizer) -
                                        without.begin());
  }
};

Move move_of(const Comparison& c, const std::vector<Featured>& pairs) {
  Order with, without;
  for (const Featured& pair : pairs) {
    with.settings.push_back(pair.problem);
    without.settings.push_back(pair.plain);
  }
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (std::ranges::all_of(pairs, [&](const Featured& pair) {
          return c.cell(pair.problem, s).is_measured() && c.cell(pair.plain, s).is_measured();
        }))
      with.methods.push_back(s);
  without.methods = with.methods;
  if (with.methods.empty()) return {};
  const std::size_t target = c.yardstick.tightest().rung;
  Move move{.with = standings_over(c, with, c.yardstick.by, target),
            .without = standings_over(c, without, c.yardstick.by, target)};
  std::map<std::size_t, Real> scores;
  for (const Ranked& each : move.without) scores[each.optimizer] = each.standing.score;
  std::vector<Real> a, b;
  for (const Ranked& each : move.with) {
    a.push_back(each.standing.score);
    b.push_back(scores.at(each.optimizer));
  }
  move.correlation = rank_correlation(a, b);
  return move;
}

// A run on noisy data: the first kept point within τδ, the best one and the last.
struct Stop {
  Real at_noise = kNever, best = kNever, last = kNever;  // errors in x over ‖x*‖
  Real work = kNever;                                    // to the first

  bool is_reached() const { return work < kNever; }
};

std::optional<Stop> stop_of(const Comparison& c, const Run& run) {
  const Record& record = *run.record;
  const std::vector<Real>&y = record.curve.discrepancy, &x = record.curve.x_error;
  if (!record.noise_level || !record.x_scale || y.empty() || is_failure(record.status) ||
      is_judged_by_fit(c, run.problem))  // whose errors are distances from the fit
    return std::nullopt;
  const Real stated = record.request.budget.discrepancy;
  const Real most = (stated > 0 ? stated : kNoiseFactor) * *record.noise_level;
  const auto finite = [&](std::size_t i) {
    return std::isfinite(x[i]) ? x[i] / *record.x_scale : kNever;
  };
  Stop stop{.last = finite(x.size() - 1)};
  for (std::size_t i = 0; i < y.size(); ++i) {
    stop.best = std::min(stop.best, finite(i));
    if (stop.is_reached() || !(y[i] <= most)) continue;
    stop.at_noise = finite(i);
    stop.work = Real(record.curve.work[i]);
  }
  return stop;
}

// Figures of all runs of a method on noisy data that come within the noise.
struct Stops {
  std::size_t runs = 0;
  std::vector<Real> work, excess, end;  // the errors over the best of the run

  void add(const Stop& stop) {
    ++runs;
    if (!stop.is_reached() || !(stop.best > 0)) return;
    work.push_back(std::max<Real>(stop.work, 1));
    excess.push_back(stop.at_noise / stop.best);
    end.push_back(stop.last / stop.best);
  }
};

}  // namespace

const OptionValues* options_of(const Comparison& c, std::size_t p) {
  for (const Cell& cell : c.cells[p])
    if (!cell.runs.empty()) return &c.runs[cell.runs[0]].record->request.problem.options;
  return nullptr;
}

Table features_table(const Comparison& c) {
  std::map<std::string, std::vector<Featured>> by_feature;
  for (Featured& each : featured_settings(c))
    if (is_rankable(c, each.problem) && is_rankable(c, each.plain))
      by_feature[each.feature].push_back(std::move(each));
  constexpr std::size_t kFewest = 3;  // settings, and methods
  Table table = worded_table("features", tau_name(c));
  std::vector<std::string> readings;
  for (const auto& [feature, pairs] : by_feature) {
    const Move move = move_of(c, pairs);
    if (pairs.size() < kFewest || move.with.size() < kFewest) continue;
    const Ranked &first = move.with[0], &before = move.without[0];
    const std::size_t place = move.place_without(first.optimizer);
    table.rows.push_back({feature,
                          count_cell(pairs.size()),
                          count_cell(move.with.size()),
                          optimizer_text(c, first.optimizer),
                          number_cell("score", first.standing.score),
                          {ordinal(place), {{"place", Real(place)}}},
                          optimizer_text(c, before.optimizer),
                          number_cell("correlation", move.correlation)});
    for (TableCell& cell : table.rows.back())
      cell.of = std::pair(pairs[0].problem, first.optimizer);
    readings.push_back(words(
        "features.move", feature, name_in_sentence(c.optimizers[first.optimizer]), ordinal(place),
        name_in_sentence(c.optimizers[before.optimizer]), move.correlation, pairs.size()));
  }
  if (table.rows.empty()) return {};
  table.reading = joined(readings, " ");
  return table;
}

Table discrepancy_table(const Comparison& c) {
  Table table = worded_table("discrepancy", kNoiseFactor);
  Stops all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    Stops own;
    for (const auto& cells : c.cells)
      for (const std::size_t row : cells[s].runs)
        if (const auto stop = stop_of(c, c.runs[row])) {
          own.add(*stop);
          all.add(*stop);
        }
    if (own.runs == 0 || table.rows.size() == kMostTableRows) continue;
    if (own.work.empty())
      add_row(table, c, s, {count_cell(own.runs), count_cell(0), "", "", "", failed_cell(c, s)});
    else
      add_row(
          table, c, s,
          {count_cell(own.runs), count_cell(own.work.size()),
           number_cell("work", median_of(own.work)), number_cell("ratio", median_of(own.excess)),
           number_cell("ratio", median_of(own.end)), failed_cell(c, s)});
  }
  if (table.rows.empty()) return {};
  table.reading = all.work.empty() ? words("discrepancy.none")
                                   : words("discrepancy.reading", all.work.size(), all.runs,
                                           kNoiseFactor, median_of(all.excess), median_of(all.end));
  return table;
}

Plots noise_plot(const Comparison& c) {
  std::map<std::size_t, std::map<Real, std::size_t>> sweeps;  // by plain setting and noise
  std::set<Real> levels;
  for (const Featured& each : featured_settings(c))
    if (each.noise > 0) sweeps[each.plain][each.noise] = each.problem;
  for (const auto& [plain, sweep] : sweeps)
    if (sweep.size() > 1)
      for (const auto& [noise, p] : sweep) levels.insert(noise);
  std::erase_if(sweeps, [&](const auto& sweep) { return sweep.second.size() < levels.size(); });
  if (levels.size() < 2 || sweeps.empty()) return {};
  Plot plot = worded_plot("plot-noise", sweeps.size(), kNoiseFactor);
  plot.kind = Plot::Kind::lines;
  plot.is_log_x = plot.is_log_y = true;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    PlotSeries line = line_of(c, s);
    for (const Real noise : levels) {
      std::vector<Real> errors;
      for (const auto& [plain, sweep] : sweeps)
        for (const std::size_t row : c.cell(sweep.at(noise), s).runs)
          if (const auto stop = stop_of(c, c.runs[row])) errors.push_back(stop->at_noise);
      const Real error = errors.empty() ? kNever : median_of(std::move(errors));
      if (error == kNever) continue;
      line.x.push_back(noise);
      line.y.push_back(error);
    }
    if (line.x.size() > 1) plot.series.push_back(std::move(line));
  }
  if (plot.series.empty()) return {};
  std::ranges::stable_sort(plot.series, {}, [](const PlotSeries& line) { return line.y.back(); });
  const PlotSeries& first = plot.series[0];
  const Real slope =
      std::log(first.y.back() / first.y.front()) / std::log(first.x.back() / first.x.front());
  plot.reading = words("plot-noise.reading", first.name, first.y.front(), 100 * first.x.front(),
                       first.y.back(), 100 * first.x.back(), slope);
  return {std::move(plot)};
}

}  // namespace isoline::reports
