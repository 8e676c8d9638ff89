// The numbers of a plot as JSON.
#include "core/json.h"

#include <nlohmann/json.hpp>

#include "reports/plots/plots.h"

namespace isoline::reports {

Json plot_json(const Plot& plot, const Comparison& c) {
  constexpr const char* kKinds[] = {"steps", "dots", "bars", "matrix"};
  const auto numbers = [](const std::vector<Real>& values) {
    return json_numbers(values.data(), values.size());
  };
  Json rows = Json::array(), series = Json::array();
  for (const PlotRow& row : plot.rows) rows.push_back(row.name);
  for (const PlotSeries& one : plot.series)
    series.push_back({{"optimizer", c.optimizers[one.optimizer].label},
                      {"name", one.name},
                      {"x", numbers(one.x)},
                      {"y", numbers(one.y)},
                      {"low", numbers(one.low)},
                      {"high", numbers(one.high)}});
  return {{"id", plot.id},
          {"kind", kKinds[static_cast<std::size_t>(plot.kind)]},
          {"title", plot.title},
          {"reading", plot.reading},
          {"caption", plot.caption},
          {"x_label", plot.x_label},
          {"y_label", plot.y_label},
          {"log_x", plot.is_log_x},
          {"rows", rows},
          {"series", series}};
}

}  // namespace isoline::reports
