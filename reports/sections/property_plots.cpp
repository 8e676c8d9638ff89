// A plot a property: a row an optimizer, a mark what was measured of it.
#include <algorithm>
#include <cmath>

#include "reports/sections/properties.h"

namespace isoline::reports {
namespace {

Real decade(Real value) {  // 1e-16 is as small as rounding lets be told
  return std::isnan(value) ? value : std::log10(std::max(value, 1e-16));
}

Plot plot_of(const Audits& all, const char* id, const char* title, std::array<Real, 2> window) {
  Plot plot{.kind = Plot::Kind::dots,
            .id = id,
            .title = title,
            .reading = "",
            .caption = "",
            .x_label = "",
            .y_label = "",
            .is_folded = true,
            .window = window};
  for (const AuditedOptimizer& audited : all)
    plot.rows.push_back({audited.name, {.method = audited.name}});
  return plot;
}

template <class Value>
void add_series(Plot& plot, const Audits& all, std::string_view name, Value value) {
  PlotSeries series{std::nullopt, std::string(name), {}, {}, {}, {}};
  for (std::size_t row = 0; row < all.size(); ++row) {
    const Real measured = all[row].reason.empty() ? value(all[row]) : kUnknown;
    if (std::isnan(measured)) continue;
    series.x.push_back(measured);
    series.y.push_back(Real(row));
  }
  plot.series.push_back(std::move(series));
}

Plot exponents_plot(const Audits& all) {
  Plot plot =
      plot_of(all, "plot-exponents", "Exponent of the first step, by what is scaled", {-1, 2});
  for (std::size_t i = 0; i < kScalingNames.size(); ++i)
    add_series(plot, all, kScalingNames[i], [i](const AuditedOptimizer& audited) {
      const PowerLaw& law = audited.scalings[i].step;
      return law.holds() ? law.exponent : kUnknown;
    });
  return plot;
}

Plot deviations_plot(const Audits& all) {
  Plot plot = plot_of(all, "plot-deviations",
                      "Deviation of the path, decades: −16 is rounding, 0 another path", {-16, 0});
  for (std::size_t i = 0; i < kChangeNames.size(); ++i)
    add_series(plot, all, kChangeNames[i],
               [i](const AuditedOptimizer& audited) { return decade(audited.deviations[i]); });
  return plot;
}

Plot orders_plot(const Audits& all) {
  const auto order = [](const Approach& approach) {
    return approach.residual <= kMostOrderResidual ? approach.order : kUnknown;
  };
  Plot plot = plot_of(all, "plot-orders", "Order of convergence", {0, 2.5});
  add_series(plot, all, "J regular", [&](const auto& audited) { return order(audited.regular); });
  add_series(plot, all, "J singular", [&](const auto& audited) { return order(audited.singular); });
  return plot;
}

Plot angles_plot(const Audits& all) {
  Plot plot = plot_of(all, "plot-angles",
                      "Angle between the change that was asked and that made, degrees", {0, 90});
  add_series(plot, all, "linear stage", [](const auto& audited) { return audited.linear_angle; });
  add_series(plot, all, "curved stage", [](const auto& audited) { return audited.curved_angle; });
  return plot;
}

Plot oracles_plot(const Audits& all) {
  Plot plot = plot_of(all, "plot-oracles", "Oracle calls an iteration, as counted", {0, 4});
  for (const char* oracle : {"forward", "pullback", "jacobian", "hessian", "inverse", "truth"})
    add_series(plot, all, oracle, [oracle](const AuditedOptimizer& audited) {
      const auto at = audited.counted.find(oracle);
      if (at == audited.counted.end() || audited.iterations == 0) return kUnknown;
      return static_cast<Real>(at->second) / static_cast<Real>(audited.iterations);
    });
  return plot;
}

}  // namespace

std::vector<Plot> property_plots(const Audits& all) {
  return {exponents_plot(all), deviations_plot(all), orders_plot(all), angles_plot(all),
          oracles_plot(all)};
}

}  // namespace isoline::reports
