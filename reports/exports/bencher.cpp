// A study as Bencher Metric Format (bencher.dev, reference/bencher-metric-format).
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/exports/exports.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

void add_measure(Json& measures, const std::string& name, const Spread& spread, Real unit = 1) {
  if (spread.n == 0 || !std::isfinite(spread.median)) return;
  Json& measure = measures[name];
  measure["value"] = spread.median * unit;
  if (std::isfinite(spread.low)) measure["lower_value"] = spread.low * unit;
  if (std::isfinite(spread.high)) measure["upper_value"] = spread.high * unit;
}

Json measures_of(const Comparison& c, const Cell& cell) {
  constexpr Real kNanoseconds = 1e9;  // the unit of Bencher's own measure "latency"
  Json measures = Json::object();
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    const std::string_view tau = c.yardstick.tolerances[t].name;
    const Spread& work = cell.taken[Measure::work][t];
    add_measure(measures, fmt::format("work-to-{}", tau), work);
    add_measure(measures, fmt::format("iterations-to-{}", tau), cell.taken[Measure::iterations][t]);
    measures[fmt::format("reached-{}", tau)]["value"] =
        work.n == 0 ? 0.0 : static_cast<Real>(work.n - work.unsolved) / static_cast<Real>(work.n);
  }
  add_measure(measures, "loss", cell.loss);
  add_measure(measures, "x-error", cell.x_error);
  std::vector<Real> seconds;
  for (const std::size_t run : cell.runs)
    seconds.push_back(c.runs[run].record->summary.wall_seconds);
  add_measure(measures, "latency", spread_of(std::move(seconds)), kNanoseconds);
  return measures;
}

}  // namespace

std::string bencher_json(const Comparison& c) {
  Json benchmarks = Json::object();
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (const Cell& cell = c.cell(p, s); cell.is_measured())
        benchmarks[fmt::format("{} × {}", c.problems[p].spec, c.optimizers[s].label)] =
            measures_of(c, cell);
  return json_text(benchmarks, 1) + "\n";
}

}  // namespace isoline::reports
