// The L-curve of a sweep of tikhonov: the penalty ‖Dx‖ over the discrepancy d = ‖y − y*‖, each for
// the run with the least loss L = ½d² + ½α‖Dx‖². Hansen (1992), SIAM Review 34:561. Its corner is
// the point of the largest Menger curvature. Cultrera, Callegaro (2020), IOP SciNotes 1:025004.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "core/results/statistics.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

struct PenalizedRun {
  Real alpha, loss;
  Real discrepancy, penalty;  // ‖y − y*‖ and ‖Dx‖
  Real x_error;               // over ‖x*‖; infinite where x* is unknown
  Real noise_level;
  std::size_t problem, optimizer;
};
using Sweep = std::map<Real, PenalizedRun, std::greater<>>;  // by α, the largest first
// By setting without tikhonov and by seed, which has noise of its own.
using Sweeps = std::map<std::string, std::map<std::uint64_t, Sweep>>;

constexpr std::size_t kFewestPoints = 5;

std::optional<PenalizedRun> penalized_run(const Run& run) {
  const Record& record = *run.record;
  const OptionValues& options = record.request.problem.options;
  const Real alpha = options.number("tikhonov", 0);
  const bool is_half = options.text("loss") != "square";  // the formula holds of ½‖y − y*‖² alone
  if (!(alpha > 0) || !is_half) return std::nullopt;
  if (record.curve.discrepancy.empty() || !record.noise_level || is_failure(record.status))
    return std::nullopt;
  const Real d = record.curve.discrepancy.back(), loss = record.curve.loss.back();
  const Real rest = 2 * loss - d * d;
  constexpr Real kLeastShare = 1e-12;  // of the loss: less is mostly rounding
  if (!(d > 0) || !std::isfinite(loss) || !(rest > kLeastShare * loss)) return std::nullopt;
  const Real error = record.x_scale ? record.curve.x_error.back() / *record.x_scale : kNever;
  return PenalizedRun{.alpha = alpha,
                      .loss = loss,
                      .discrepancy = d,
                      .penalty = std::sqrt(rest / alpha),
                      .x_error = error,
                      .noise_level = *record.noise_level,
                      .problem = run.problem,
                      .optimizer = run.optimizer};
}

Sweeps sweeps_of(const Comparison& c) {
  Sweeps sweeps;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (const Cell& cell : c.cells[p])
      for (const std::size_t row : cell.runs)
        if (const auto run = penalized_run(c.runs[row])) {
          Sweep& sweep = sweeps[spec_without(c.problems[p].spec, "tikhonov")][c.runs[row].seed];
          const auto [at, is_new] = sweep.try_emplace(run->alpha, *run);
          if (!is_new && run->loss < at->second.loss) at->second = *run;
        }
  for (auto& [spec, by_seed] : sweeps)
    std::erase_if(by_seed, [](const auto& each) { return each.second.size() < kFewestPoints; });
  std::erase_if(sweeps, [](const auto& each) { return each.second.empty(); });
  return sweeps;
}

// From the largest α down, d falls and ‖Dx‖ rises; points that do otherwise, or lie closer than
// 1 % to the last one, are left out. Three of them have the curvature 4 · area / (a b c) of their
// triangle in logarithms, positive where the curve turns toward the larger ‖Dx‖.
const PenalizedRun* corner_of(const Sweep& sweep) {
  constexpr Real kLeastStep = 0.01;
  std::vector<const PenalizedRun*> kept;
  const auto step = [](const PenalizedRun& a, const PenalizedRun& b) {
    return std::pair(std::log(b.discrepancy / a.discrepancy), std::log(b.penalty / a.penalty));
  };
  for (const auto& [alpha, run] : sweep) {
    const auto [dx, dy] = kept.empty() ? std::pair<Real, Real>(-1, 1) : step(*kept.back(), run);
    if (dx <= 0 && dy >= 0 && std::hypot(dx, dy) >= kLeastStep) kept.push_back(&run);
  }
  const PenalizedRun* corner = nullptr;
  Real largest = 0;
  for (std::size_t i = 1; i + 1 < kept.size(); ++i) {
    const auto [ax, ay] = step(*kept[i - 1], *kept[i]);
    const auto [bx, by] = step(*kept[i], *kept[i + 1]);
    const Real curvature = 2 * (bx * ay - ax * by) /
                           (std::hypot(ax, ay) * std::hypot(bx, by) * std::hypot(ax + bx, ay + by));
    if (curvature <= largest) continue;
    largest = curvature;
    corner = kept[i];
  }
  return corner;
}

// α and the error in x by each of the three rules, a value per seed.
struct ByRule {
  std::vector<Real> log_alpha, error;
  const PenalizedRun* first = nullptr;  // that it chose

  void add(const PenalizedRun* run) {
    if (first == nullptr) first = run;
    log_alpha.push_back(run == nullptr ? kNever : std::log(run->alpha));
    error.push_back(run == nullptr ? kNever : run->x_error);
  }
  Spread alphas() const {  // their median in logarithms
    Spread spread = spread_of(log_alpha);
    for (Real* each : {&spread.median, &spread.low, &spread.high}) *each = std::exp(*each);
    return spread;
  }
  Spread errors() const { return spread_of(error); }
  void append_to(std::vector<TableCell>& row) const {
    row.push_back({figure(alphas()), {{"alpha", alphas().median}}});
    row.push_back({figure(errors()), {{"error", errors().median}}});
    if (first == nullptr) return;
    for (TableCell* each : {&row.back(), &row[row.size() - 2]})
      each->of = std::pair(first->problem, first->optimizer);
  }
};

}  // namespace

Table l_curve_table(const Comparison& c) {
  Table table = worded_table("l-curve", kNoiseFactor);
  std::vector<std::string> readings;
  const Sweeps sweeps = sweeps_of(c);
  for (const auto& [spec, by_seed] : sweeps) {
    ByRule corner, at_noise, best;
    std::size_t values = 0;
    for (const auto& [seed, sweep] : by_seed) {
      corner.add(corner_of(sweep));
      const auto is_within = [](const auto& each) {
        return each.second.discrepancy <= kNoiseFactor * each.second.noise_level;
      };
      const auto first = std::ranges::find_if(sweep, is_within);
      at_noise.add(first == sweep.end() ? nullptr : &first->second);
      const auto error = [](const auto& each) { return each.second.x_error; };
      best.add(&std::ranges::min_element(sweep, {}, error)->second);
      values = std::max(values, sweep.size());
    }
    std::vector<TableCell> row = {shown_spec(spec), count_cell(by_seed.size()), count_cell(values)};
    for (const ByRule* each : {&corner, &at_noise, &best}) each->append_to(row);
    for (TableCell& cell : row)  // a rule that chooses no α has the run of the best one
      if (!cell.of) cell.of = row.back().of;
    row[0].of.reset();
    table.rows.push_back(std::move(row));
    readings.push_back(words("l-curve.reading", shown_spec(spec), corner.alphas().median,
                             corner.errors().median, best.alphas().median, best.errors().median));
  }
  if (table.rows.empty()) return {};
  constexpr std::size_t kMostReadings = 3;
  readings.resize(std::min(readings.size(), kMostReadings));
  table.reading = joined(readings, " ");
  return table;
}

Plots l_curve_plot(const Comparison& c) {
  Plot plot = worded_plot("plot-l-curve");
  plot.kind = Plot::Kind::lines;
  plot.is_log_x = plot.is_log_y = true;
  for (const auto& [spec, by_seed] : sweeps_of(c)) {
    if (plot.series.size() >= kMostLines) break;
    const auto& [seed, sweep] = *by_seed.begin();
    PlotSeries line{.name = shown_spec(spec)};
    for (const auto& [alpha, run] : sweep) {
      line.x.push_back(run.discrepancy);
      line.y.push_back(run.penalty);
    }
    if (const PenalizedRun* corner = corner_of(sweep)) {  // above the line
      plot.series.push_back({.name = words("plot-l-curve.corner", corner->alpha),
                             .x = {corner->discrepancy},
                             .y = {corner->penalty}});
      if (plot.reading.empty())
        plot.reading =
            words("plot-l-curve.reading", shown_spec(spec), corner->alpha, corner->discrepancy,
                  corner->discrepancy / corner->noise_level, corner->penalty);
    }
    plot.series.push_back(std::move(line));
  }
  if (plot.series.empty()) return {};
  return {std::move(plot)};
}

}  // namespace isoline::reports
