// Work over the number of unknowns n: settings that differ in one numeric option alone, which
// changes n, and the slope of log work over log n.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <variant>

#include "core/options.h"
#include "core/results/statistics.h"
#include "reports/sections/drawings.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kFewestSizes = 3, kFewestForRange = 4;

struct SizeSweep {
  std::string name;                         // "burgers (N)"
  std::map<Index, std::size_t> settings{};  // by unknowns
};

std::vector<SizeSweep> size_sweeps(const Comparison& c) {
  std::map<std::string, SizeSweep> all;  // by the problem, the option, and the other options
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const ProblemAxis& problem = c.problems[p];
    const OptionValues* options = options_of(c, p);
    if (options == nullptr || problem.is_learned || !problem.has_own_sheet()) continue;
    for (const auto& [option, value] : *options) {
      if (!std::holds_alternative<Real>(value) && !std::holds_alternative<Index>(value)) continue;
      std::string key = fmt::format("{} {}", problem.name, option);
      for (const auto& [name, other] : *options)
        if (name != option) key += fmt::format(" {}={}", name, option_text(other));
      const std::string rest = spec_without(problem.spec, option);
      SizeSweep& sweep = all[key];
      sweep.name = fmt::format("{} ({})", shown_spec(rest), option);
      sweep.settings.try_emplace(problem.sheet->unknowns, p);
    }
  }
  std::vector<SizeSweep> sweeps;
  for (auto& [key, sweep] : all)
    if (sweep.settings.size() >= kFewestSizes) sweeps.push_back(std::move(sweep));
  return sweeps;
}

// The sizes that a method solves, and how its work grows with them.
struct Growth {
  std::size_t asked = 0;
  std::vector<Real> unknowns, work;
  Real slope = kNever, low = kNever, high = kNever;  // between neighbours at least and at most

  std::string text() const {
    std::string text = slope == kNever ? "–" : fmt::format("{:.2f}", slope);
    if (unknowns.size() >= kFewestForRange) text += fmt::format(" ({:.2f} to {:.2f})", low, high);
    if (unknowns.size() < asked)
      text += ", " + words("size.unsolved", asked - unknowns.size(), asked);
    return text;
  }
};

Growth growth_of(const Comparison& c, const SizeSweep& sweep, std::size_t s) {
  Growth growth;
  for (const auto& [unknowns, p] : sweep.settings) {
    const Cell& cell = c.cell(p, s);
    if (cell.planned == 0 || !cell.inapplicable.empty()) continue;
    ++growth.asked;
    const Real work = cell.headline[kTightest].median;
    if (!(work < kNever)) continue;
    growth.unknowns.push_back(static_cast<Real>(unknowns));
    growth.work.push_back(std::max(work, least_unit(c.yardstick.by)));
  }
  const std::size_t n = growth.work.size();
  if (n < kFewestSizes) return growth;
  growth.slope = results::log_slope(growth.unknowns, growth.work).first;
  growth.low = kNever;
  growth.high = -kNever;
  for (std::size_t i = 1; i < n; ++i) {
    const Real local = std::log(growth.work[i] / growth.work[i - 1]) /
                       std::log(growth.unknowns[i] / growth.unknowns[i - 1]);
    growth.low = std::min(growth.low, local);
    growth.high = std::max(growth.high, local);
  }
  return growth;
}

struct MethodGrowth {
  std::size_t optimizer = 0;
  Growth growth;
};

// Those that solve the largest sizes first, by their work there.
std::vector<MethodGrowth> ordered_growths(const Comparison& c, const SizeSweep& sweep) {
  std::vector<MethodGrowth> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (MethodGrowth each{s, growth_of(c, sweep, s)}; each.growth.work.size() > 1)
      all.push_back(std::move(each));
  std::ranges::stable_sort(all, {}, [](const MethodGrowth& each) {
    return std::pair(-each.growth.unknowns.back(), each.growth.work.back());
  });
  return all;
}

}  // namespace

Table size_table(const Comparison& c) {
  const std::vector<SizeSweep> sweeps = size_sweeps(c);
  if (sweeps.empty()) return {};
  Table table = worded_table("size", counted_name(c), tau_name(c), kFewestSizes, kFewestForRange);
  std::vector<std::string> readings;
  for (const SizeSweep& sweep : sweeps) {
    table.columns.push_back(sweep.name);
    const std::vector<MethodGrowth> all = ordered_growths(c, sweep);
    if (all.empty() || all[0].growth.slope == kNever) continue;
    const Growth& first = all[0].growth;
    readings.push_back(words("size.reading", sweep.name, first.unknowns.back(),
                             name_in_sentence(c.optimizers[all[0].optimizer]), first.work.back(),
                             unit_name(c), first.slope));
  }
  table.columns.emplace_back("failed");
  for (std::size_t s = 0; s < c.optimizers.size() && table.rows.size() < kMostTableRows; ++s) {
    std::vector<TableCell> row;
    bool is_asked = false;
    for (const SizeSweep& sweep : sweeps) {
      const Growth growth = growth_of(c, sweep, s);
      is_asked = is_asked || growth.asked > 0;
      row.push_back(growth.asked == 0
                        ? TableCell("")
                        : TableCell(growth.text(), {{"slope", growth.slope},
                                                    {"solved", Real(growth.work.size())},
                                                    {"sizes", Real(growth.asked)}}));
    }
    row.push_back(failed_cell(c, s));
    if (is_asked) add_row(table, c, s, std::move(row));
  }
  table.reading = readings.empty() ? words("size.none", tau_name(c)) : joined(readings, " ");
  return table;
}

Plots size_plots(const Comparison& c) {
  Plots plots;
  for (const SizeSweep& sweep : size_sweeps(c)) {
    std::vector<MethodGrowth> all = ordered_growths(c, sweep);
    if (all.empty()) continue;
    Plot plot = worded_plot("plot-size", sweep.name, counted_to_tau(c));
    plot.id = fmt::format("plot-size-{}", plots.size());
    plot.kind = Plot::Kind::lines;
    plot.is_log_x = plot.is_log_y = true;
    const MethodGrowth& first = all[0];
    plot.reading = words("plot-size.reading", name_in_sentence(c.optimizers[first.optimizer]),
                         first.growth.unknowns.back());
    for (MethodGrowth& each : all) {
      PlotSeries& line = plot.series.emplace_back(line_of(c, each.optimizer));
      line.x = std::move(each.growth.unknowns);
      line.y = std::move(each.growth.work);
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace isoline::reports
