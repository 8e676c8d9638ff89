// The choice of each pair, and how its grid looked.
#include "benchmarks/cli/tuning_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reports/formats/formats.h"
#include "reports/formats/text_plot.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;
using reports::figure;
using reports::Plot;
using reports::reached_figure;
using reports::Section;
using reports::Table;
namespace {

bool is_failed(const TuningScore& score) {
  return !std::isfinite(score.work) && !std::isfinite(score.left);
}

// A bar a value, by its place among the scores: the best highest, a dot where it failed.
std::string bars(const TunedOption& tuned) {
  constexpr std::array<const char*, 8> kBars = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  std::vector<TuningScore> ordered;
  for (const TuningScore& score : tuned.scores)
    if (!is_failed(score)) ordered.push_back(score);
  std::ranges::sort(ordered, [](const auto& a, const auto& b) { return a < b; });
  ordered.erase(std::ranges::unique(ordered).begin(), ordered.end());
  std::string text;
  for (const TuningScore& score : tuned.scores) {
    const auto place =
        static_cast<std::size_t>(std::ranges::find(ordered, score) - ordered.begin());
    const std::size_t worst = std::max<std::size_t>(1, ordered.size() - 1);
    text += is_failed(score) ? "·" : kBars[(worst - std::min(place, worst)) * 7 / worst];
  }
  return text;
}

// The other values whose scores equal the best's.
std::vector<std::string> ties_of(const TunedOption& tuned) {
  std::vector<std::string> ties;
  for (std::size_t i = 0; i < tuned.values.size(); ++i)
    if (i != tuned.best && tuned.scores[i] == tuned.scores[tuned.best])
      ties.push_back(figure(tuned.values[i]));
  return ties;
}

const char* edge_of(const TunedOption& tuned) {
  if (!tuned.is_at_edge) return "";
  return tuned.best == 0 ? "lowest" : "highest";
}

std::vector<reports::TableCell> row_of(const TunedOption& tuned) {
  const TuningScore& best = tuned.scores[tuned.best];
  std::string remark;
  if (tuned.is_at_edge) remark = fmt::format("at the edge: the {} value tried", edge_of(tuned));
  if (const auto ties = ties_of(tuned); !ties.empty())
    remark += (remark.empty() ? "ties with " : "; ties with ") + reports::joined(ties);
  if (is_failed(best)) remark = "every value failed: the one nearest to the default stays";
  return {tuned.problem,
          tuned.optimizer,
          tuned.option,
          figure(tuned.values[tuned.best]),
          bars(tuned),
          reached_figure(best.work),
          reached_figure(best.left),
          remark};
}

std::string summary_of(const TuningResult& result) {
  std::size_t edges = 0, ties = 0;
  for (const TunedOption& tuned : result.tuned) {
    edges += tuned.is_at_edge;
    ties += !ties_of(tuned).empty();
  }
  std::string text =
      fmt::format("{} tuned: {} with the best at the edge of the grid, {} with a tie",
                  counted(result.tuned.size(), "pair"), edges, ties);
  if (result.inapplicable > 0) text += fmt::format("; {} not applicable", result.inapplicable);
  return text + fmt::format(". {} in {}.", counted(std::size_t(result.outcome.run), "run"),
                            duration_text(result.outcome.seconds));
}

// By what decides: the work where any value reaches the target, else what is left.
Plot plot_of(const TunedOption& tuned) {
  const bool is_reached = std::ranges::any_of(
      tuned.scores, [](const TuningScore& score) { return std::isfinite(score.work); });
  Plot plot{
      .kind = Plot::Kind::lines,
      .x_label = tuned.option,
      .y_label = is_reached ? "median work to the target" : "median of what is left at the end",
      .is_log_x = true,
      .is_log_y = true};
  reports::PlotSeries line{.name = fmt::format("{} × {}", tuned.problem, tuned.optimizer)};
  for (std::size_t i = 0; i < tuned.values.size(); ++i) {
    const Real value = is_reached ? tuned.scores[i].work : tuned.scores[i].left;
    line.x.push_back(tuned.values[i]);
    line.y.push_back(std::isfinite(value) && value > 0 ? value : std::nan(""));
  }
  plot.series.push_back(std::move(line));
  return plot;
}

}  // namespace

std::string tuning_text(const TuningResult& result, bool lists_all) {
  Section section{.id = "tuning", .title = "Tuning", .otherwise = "No pair could be tuned."};
  section.readings = {{"", summary_of(result)}};
  Table table{.columns = {"problem", "optimizer", "option", "best", "grid", "work", "left", ""},
              .align = "lllrlrrl",
              .names = 2};
  table.caption =
      "Grid: a bar a value from the lowest to the highest, the best highest, · failed. Work: median "
      "to the target, ✗ not reached; left: median of the loss, or of the error in x, at the end.";
  for (const TunedOption& tuned : result.tuned) table.rows.push_back(row_of(tuned));
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
  std::string text =
      reports::terminal_section(section, lists_all ? reports::kAllRows : reports::kFewRows);
  const bool is_one = result.tuned.size() == 1 && result.tuned[0].values.size() > 1;
  if (is_one) text += "\n" + reports::text_plot(plot_of(result.tuned[0]));
  return text;
}

}  // namespace isoline::benchmarks
