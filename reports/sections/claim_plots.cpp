// Plots of claims: curves over iterations, or values over an abscissa, with the published band at
// the place where the quantity is read.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/sections/claims.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// The expected value of a quantity that is read at one point: for a ratio, the place of the first
// of two terms relative to the second.
std::vector<PlotSeries> goals_of(const Evidence& evidence) {
  const bool is_ratio = evidence.kind == "ratio";
  const bool is_height = is_ratio || evidence.kind == "value" || evidence.kind == "greatest";
  if (evidence.curve != evidence.column || !is_height) return {};  // positions are not values
  const Real unit = is_ratio ? evidence.terms.at(1).level : 1;
  return {{.optimizer = {},
           .name = "published",
           .x = {evidence.terms.at(0).read_at},
           .y = {unit * evidence.published},
           .low = {unit * evidence.band.low},
           .high = {unit * evidence.band.high}}};
}

// One line per term. Terms that read the same runs at several places share a line.
Plot curves(const Evidence& evidence) {
  Plot plot = worded_plot(evidence.is_over_time ? "curves-over-time" : "curves");
  plot.y_label = column_words(evidence.curve);
  const std::vector<std::string> names = term_names(evidence);
  for (std::size_t i = 0; i < evidence.terms.size(); ++i) {
    const EvidenceTerm& term = evidence.terms[i];
    const bool is_known = std::ranges::any_of(
        evidence.terms.begin(), evidence.terms.begin() + std::ptrdiff_t(i),
        [&](const EvidenceTerm& other) {
          return other.runs.at(0).cell == term.runs.at(0).cell && other.scale == term.scale;
        });
    if (is_known) continue;
    plot.series.push_back({{}, names[i], term.x, term.y, term.low, term.high});
    plot.series.back().method = term.method;
  }
  constexpr Real kLong = 100;
  plot.is_log_x = plot.series.at(0).x.back() > kLong || evidence.is_over_time;
  plot.published = goals_of(evidence);
  if (!plot.published.empty())
    plot.caption += " " + (evidence.kind == "ratio" ? words("curves.ratio", names[0], names.at(1))
                                                    : words("curves.value"));
  return plot;
}

// Terms by their abscissas.
PlotSeries over_abscissa(std::vector<EvidenceTerm> terms) {
  std::ranges::sort(terms, {}, &EvidenceTerm::at);
  const bool is_one = std::ranges::all_of(
      terms, [&](const EvidenceTerm& term) { return term.optimizer == terms[0].optimizer; });
  PlotSeries line{.name = is_one ? shown_spec(terms[0].optimizer) : terms[0].method,
                  .method = terms[0].method};
  for (const EvidenceTerm& term : terms) {
    const auto [low, high] = std::ranges::minmax(term.runs, {}, &EvidenceRun::figure);
    line.x.push_back(term.at);
    line.y.push_back(term.level);
    line.low.push_back(low.figure);
    line.high.push_back(high.figure);
  }
  return line;
}

// A power law of the published slope through the middle of the figures, and its steepest and
// flattest neighbours.
PlotSeries published_slope(const Evidence& evidence, const PlotSeries& line) {
  Real mean_x = 0, mean_y = 0;
  const auto n = static_cast<Real>(line.x.size());
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    mean_x += std::log(line.x[i]) / n;
    mean_y += std::log(line.y[i]) / n;
  }
  PlotSeries out{.name = "published"};
  for (const Real x : {std::log(line.x.front()), mean_x, std::log(line.x.back())}) {
    const auto at = [&](Real slope) { return std::exp(mean_y + slope * (x - mean_x)); };
    const Real one = at(evidence.band.low), other = at(evidence.band.high);
    out.x.push_back(std::exp(x));
    out.y.push_back(at(evidence.published));
    out.low.push_back(std::min(one, other));
    out.high.push_back(std::max(one, other));
  }
  return out;
}

// The ratios of the medians of the first half of the terms to those of the second half.
PlotSeries ratios_of(const PlotSeries& over, const PlotSeries& under) {
  PlotSeries line{.name = over.name + " / " + under.name, .x = over.x, .y = over.y};
  for (std::size_t i = 0; i < line.y.size(); ++i) line.y[i] /= under.y.at(i);
  return line;
}

Plot figures_over_abscissa(const Evidence& evidence) {
  const auto is_iteration = [](const EvidenceTerm& term) {
    return term.iteration && static_cast<Real>(*term.iteration) == term.at;
  };
  std::string abscissa = evidence.abscissa;
  if (abscissa.empty())
    abscissa = std::ranges::all_of(evidence.terms, is_iteration) ? "iterations" : "abscissa";
  Plot plot = worded_plot("over-abscissa", abscissa, column_words(evidence.column));
  plot.is_log_x = true;
  const auto middle = evidence.terms.begin() + std::ssize(evidence.terms) / 2;
  const PlotSeries first = over_abscissa({evidence.terms.begin(), middle}),
                   second = over_abscissa({middle, evidence.terms.end()});
  if (evidence.kind != "crossing") {
    const bool is_of_ratios = evidence.kind == "ratio_slope";
    plot.series = {is_of_ratios ? ratios_of(first, second) : over_abscissa(evidence.terms)};
    if (is_of_ratios) plot.y_label += ", ratio";
    plot.published = {published_slope(evidence, plot.series[0])};
    plot.caption += " " + words("over-abscissa.slope");
    return plot;
  }
  plot.series = {first, second};
  const Agreement& band = evidence.band;
  plot.published = {{.optimizer = {},
                     .name = "published",
                     .x = {band.low, evidence.published, band.high},
                     .y = {},
                     .low = std::vector<Real>(3, 0),
                     .high = std::vector<Real>(3, kNever)}};
  plot.caption += " " + words("over-abscissa.crossing");
  return plot;
}

// Logarithmic if all plotted values are positive and span more than a factor of ten.
bool is_logarithmic(const Plot& plot) {
  constexpr Real kWide = 10;
  Real low = kNever, high = 0;
  for (const auto* all : {&plot.series, &plot.published})
    for (const PlotSeries& line : *all)
      for (const Real y : line.y) {
        if (!std::isfinite(y)) continue;
        low = std::min(low, y);
        high = std::max(high, y);
      }
  return low > 0 && high > kWide * low;
}

}  // namespace

std::vector<std::string> term_names(const Evidence& evidence) {
  const auto is_one = [&](const std::string EvidenceTerm::*part) {
    return std::ranges::all_of(evidence.terms, [&](const EvidenceTerm& term) {
      return term.*part == evidence.terms[0].*part;
    });
  };
  const bool has_abscissa = !evidence.abscissa.empty();  // distinguishes the problems
  const bool one_problem = has_abscissa || is_one(&EvidenceTerm::problem);
  const bool one_optimizer = is_one(&EvidenceTerm::optimizer) && !one_problem;
  std::vector<std::string> names;
  for (const EvidenceTerm& term : evidence.terms) {
    std::string& name =
        names.emplace_back(shown_spec(one_optimizer ? term.problem : term.optimizer));
    if (!one_problem && !one_optimizer) name += " on " + shown_spec(term.problem);
    if (term.scale != 1) name += fmt::format(", times {}", figure(term.scale));
    if (has_abscissa) name += fmt::format(", {} = {}", evidence.abscissa, figure(term.at));
  }
  return names;
}

std::vector<Plot> claim_plots(const Evidence& evidence, const std::string& id) {
  if (evidence.terms.empty()) return {};
  const bool has_abscissa = evidence.kind.ends_with("slope") || evidence.kind == "crossing";
  const bool has_curves =
      evidence.printed.empty() &&
      std::ranges::none_of(evidence.terms, [](const EvidenceTerm& term) { return term.x.empty(); });
  if (!has_abscissa && !has_curves) return {};
  Plot plot = has_abscissa ? figures_over_abscissa(evidence) : curves(evidence);
  plot.kind = Plot::Kind::lines;
  plot.id = "plot-" + id;
  plot.is_log_y = is_logarithmic(plot);
  return {plot};
}

}  // namespace isoline::reports
