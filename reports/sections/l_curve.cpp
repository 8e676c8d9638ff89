// The L-curve of a sweep of tikhonov: the penalty ‖Dx‖ over the discrepancy d = ‖y − y*‖, each for
// the run with the least loss L = ½d² + ½α‖Dx‖². Hansen (1992), SIAM Review 34:561. Its corner is
// the point of the largest curvature after smoothing, so that it does not depend on how densely α
// is sampled. Generalized cross-validation is a second opinion for linear problems: Golub, Heath,
// Wahba (1979), Technometrics 21:215.
#include <algorithm>
#include <array>
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
  std::size_t data = 0;             // without the rows of the penalty
  std::vector<Real> singular = {};  // of J with them, where the problem is linear and D = I
};
using Sweep = std::map<Real, PenalizedRun, std::greater<>>;  // by α, the largest first
// By setting without tikhonov and by seed, which has noise of its own.
using Sweeps = std::map<std::string, std::map<std::uint64_t, Sweep>>;

constexpr std::size_t kFewestPoints = 5;

std::optional<PenalizedRun> penalized_run(const Comparison& c, const Run& run) {
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
  std::size_t data = 0;
  std::vector<Real> singular;
  if (const ProblemAxis& problem = c.problems[run.problem];
      problem.is_linear() && problem.has_own_sheet() && options.number("order", 0) == 0 &&
      record.spectrum && !record.spectrum->sigma.empty()) {
    singular = record.spectrum->sigma.back();
    data = static_cast<std::size_t>(problem.sheet->residuals) - singular.size();
  }
  return PenalizedRun{.alpha = alpha,
                      .loss = loss,
                      .discrepancy = d,
                      .penalty = std::sqrt(rest / alpha),
                      .x_error = error,
                      .noise_level = *record.noise_level,
                      .problem = run.problem,
                      .optimizer = run.optimizer,
                      .data = data,
                      .singular = std::move(singular)};
}

Sweeps sweeps_of(const Comparison& c) {
  Sweeps sweeps;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (const Cell& cell : c.cells[p])
      for (const std::size_t row : cell.runs)
        if (const auto run = penalized_run(c, c.runs[row])) {
          Sweep& sweep = sweeps[spec_without(c.problems[p].spec, "tikhonov")][c.runs[row].seed];
          const auto [at, is_new] = sweep.try_emplace(run->alpha, *run);
          if (!is_new && run->loss < at->second.loss) at->second = *run;
        }
  for (auto& [spec, by_seed] : sweeps)
    std::erase_if(by_seed, [](const auto& each) { return each.second.size() < kFewestPoints; });
  std::erase_if(sweeps, [](const auto& each) { return each.second.empty(); });
  return sweeps;
}

// The first and second derivative at t₀ of values over t = log10 α: a parabola through those within
// a decade, or through the five nearest, with tricube weights. Cleveland (1979), JASA 74:829.
struct Slopes {
  Real first, second;
};
Slopes smoothed_at(const std::vector<Real>& t, const std::vector<Real>& values, std::size_t at) {
  constexpr Real kWidth = 1, kWider = 1.001;
  std::vector<Real> distances;
  for (const Real each : t) distances.push_back(std::abs(each - t[at]));
  std::ranges::nth_element(distances, distances.begin() + kFewestPoints - 1);
  const Real width = std::max(kWidth, kWider * distances[kFewestPoints - 1]);
  std::array<Real, 5> moments{};  // Σ w uᵏ
  std::array<Real, 3> right{};    // Σ w uᵏ v
  for (std::size_t i = 0; i < t.size(); ++i) {
    const Real u = (t[i] - t[at]) / width, v = values[i] - values[at];
    Real weight = std::pow(std::max(0.0, 1 - std::pow(std::abs(u), 3)), 3);
    for (std::size_t k = 0; k < moments.size(); ++k, weight *= u) {
      moments[k] += weight;
      if (k < right.size()) right[k] += weight * v;
    }
  }
  const auto determinant = [](const std::array<std::array<Real, 3>, 3>& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  std::array<std::array<Real, 3>, 3> normal{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) normal[i][j] = moments[i + j];
  const auto coefficient = [&](std::size_t column) {  // Cramer's rule
    auto replaced = normal;
    for (std::size_t i = 0; i < 3; ++i) replaced[i][column] = right[i];
    return determinant(replaced) / determinant(normal);
  };
  return {coefficient(1) / width, 2 * coefficient(2) / (width * width)};
}

// A value of α that a rule chooses, and its neighbours in the sweep.
struct Chosen {
  const PenalizedRun* run = nullptr;
  Real below = kNever, above = kNever;
};
Chosen chosen_at(const std::vector<const PenalizedRun*>& runs, std::size_t at) {
  return {runs[at], runs[std::min(at + 1, runs.size() - 1)]->alpha,
          runs[at == 0 ? 0 : at - 1]->alpha};
}

std::vector<const PenalizedRun*> runs_of(const Sweep& sweep) {
  std::vector<const PenalizedRun*> runs;
  for (const auto& [alpha, run] : sweep) runs.push_back(&run);
  return runs;
}

// With increasing α, log d rises and log ‖Dx‖ falls, the steepest at first: the curve is convex at
// the corner. Its two ends have no neighbour on one side.
Chosen corner_of(const Sweep& sweep) {
  const std::vector<const PenalizedRun*> runs = runs_of(sweep);
  std::vector<Real> t, d, p;
  for (const PenalizedRun* run : runs) {
    t.push_back(std::log10(run->alpha));
    d.push_back(std::log(run->discrepancy));
    p.push_back(std::log(run->penalty));
  }
  Chosen corner;
  Real largest = 0;
  for (std::size_t i = 1; i + 1 < runs.size(); ++i) {
    const Slopes x = smoothed_at(t, d, i), y = smoothed_at(t, p, i);
    const Real curvature = (x.first * y.second - y.first * x.second) /
                           std::pow(x.first * x.first + y.first * y.first, 1.5);
    if (!(curvature > largest)) continue;
    largest = curvature;
    corner = chosen_at(runs, i);
  }
  return corner;
}

// The least d²/(m − tr A)², A the matrix that takes y* to y. The rows of the penalty are √α times
// the identity, so that tr A = Σ (1 − α/s²) over the singular values s of both.
Chosen by_cross_validation(const Sweep& sweep) {
  const std::vector<const PenalizedRun*> runs = runs_of(sweep);
  Chosen chosen;
  Real least = kNever;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i]->singular.empty()) return {};
    Real left = static_cast<Real>(runs[i]->data);
    for (const Real s : runs[i]->singular) left -= 1 - runs[i]->alpha / (s * s);
    const Real value = std::pow(runs[i]->discrepancy / left, 2);
    if (!(value < least)) continue;
    least = value;
    chosen = chosen_at(runs, i);
  }
  return chosen;
}

// α and the error in x by each of the rules, a value per seed.
struct ByRule {
  std::vector<Real> log_alpha, error, below, above;
  const PenalizedRun* first = nullptr;  // that it chose

  void add(const Chosen& chosen) {
    add(chosen.run);
    below.push_back(std::log(chosen.below));
    above.push_back(std::log(chosen.above));
  }
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
  // The neighbours in the sweep, as medians: α is known no better.
  Real least() const { return std::exp(spread_of(below).median); }
  Real most() const { return std::exp(spread_of(above).median); }
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
    ByRule corner, validated, at_noise, best;
    std::size_t values = 0;
    for (const auto& [seed, sweep] : by_seed) {
      corner.add(corner_of(sweep));
      validated.add(by_cross_validation(sweep));
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
    for (const ByRule* each : {&corner, &validated, &at_noise, &best}) each->append_to(row);
    for (TableCell& cell : row)  // a rule that chooses no α has the run of the best one
      if (!cell.of) cell.of = row.back().of;
    row[0].of.reset();
    table.rows.push_back(std::move(row));
    readings.push_back(words("l-curve.reading", shown_spec(spec), corner.alphas().median,
                             corner.least(), corner.most(), corner.errors().median,
                             best.alphas().median, best.errors().median));
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
    if (const PenalizedRun* corner = corner_of(sweep).run) {  // above the line
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
