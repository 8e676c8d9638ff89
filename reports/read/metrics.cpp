// Names of rungs, and yardsticks of other tolerances.
#include "reports/read/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/results/statistics.h"

namespace isoline::reports {

using namespace results;
namespace {

// "1e-4", "1.6e-4": two digits tell a rung from its neighbours.
std::string rung_name(std::size_t j) {
  if (j == 0) return "1";
  std::string text = fmt::format("{:.1e}", rung(j));
  if (const std::size_t zero = text.find(".0"); zero != std::string::npos) text.erase(zero, 2);
  if (const std::size_t zero = text.find("e-0"); zero != std::string::npos) text.erase(zero + 2, 1);
  return text;
}

const std::vector<std::string>& rung_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (std::size_t j = 0; j < kRungs; ++j) all.push_back(rung_name(j));
    return all;
  }();
  return names;
}

Tolerance tolerance_of_rung(std::size_t j) { return {rung_names()[j], rung(j), j}; }

}  // namespace

std::optional<Measure> measure_of(std::string_view name) {
  for (const Measure measure : kMeasures)
    if (name_of(measure) == name) return measure;
  return std::nullopt;
}

Tolerance tolerance_at(Real tau) { return tolerance_of_rung(rung_of(tau)); }

// The usual looser ones stay where they are looser; else a third and two thirds of the way down.
Yardstick yardstick_at(Measure by, Real tau) {
  Yardstick yardstick{.by = by};
  const Tolerance last = tolerance_at(tau);
  const bool is_usual = kTolerances[kTightest - 1].rung < last.rung;
  for (std::size_t t = 0; t < kTightest && !is_usual; ++t)
    yardstick.tolerances[t] = tolerance_of_rung((t + 1) * last.rung / kTolerances.size());
  yardstick.tolerances[kTightest] = last;
  return yardstick;
}

// Raw counts times prices.

namespace {

using Columns = std::map<std::string, std::vector<std::int64_t>>;

const std::vector<std::int64_t>* column_of(const Columns& columns, std::size_t kind) {
  const auto at = columns.find(std::string(kOracleNames[kind]));
  return at == columns.end() ? nullptr : &at->second;
}

// y between the points (x, y), both ascending; beyond their ends the nearest.
Real between(const std::vector<std::int64_t>& x, const std::vector<Real>& y, Real at) {
  const auto right = std::ranges::lower_bound(x, at, {}, [](auto value) { return Real(value); });
  if (right == x.end()) return y.back();
  const auto i = static_cast<std::size_t>(right - x.begin());
  if (i == 0 || Real(x[i]) == at) return y[i];
  const Real share = (at - Real(x[i - 1])) / Real(x[i] - x[i - 1]);
  return y[i - 1] + share * (y[i] - y[i - 1]);
}

}  // namespace

bool is_told(const MeasuredPrices& prices, const MeasuredPrice& price) {
  const Real unit = prices.forward_seconds;
  return price.resolved && unit >= kShortestCall && price.price * unit >= kShortestCall;
}

Prices::Prices(const Sheet* sheet) {
  if (sheet == nullptr || !sheet->prices) return;
  for (const MeasuredPrice& each : sheet->prices->oracles)
    if (each.oracle != kInference && is_told(*sheet->prices, each))
      measured_[each.oracle] = each.price;
}

Real Prices::price(const Record& record, std::size_t kind) const {
  const auto at = measured_.find(kOracleNames[kind]);
  return at == measured_.end() ? Real(record.prices[kind]) : at->second;
}

Real Prices::cost(const Record& record) const {
  if (!are_measured()) return Real(record.summary.work);
  Real sum = 0;
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    sum += price(record, kind) * Real(record.counts[kind]);
  return sum;
}

std::vector<Real> Prices::curve_costs(const Record& record) const {
  const Curve& curve = record.curve;
  if (!are_measured() || curve.counts.empty()) return {curve.work.begin(), curve.work.end()};
  std::vector<Real> costs(curve.work.size(), 0);
  for (std::size_t kind = 0; kind < kOracles; ++kind) {
    const auto* column = column_of(curve.counts, kind);
    const Real each = price(record, kind);
    for (std::size_t i = 0; column != nullptr && i < std::min(costs.size(), column->size()); ++i)
      costs[i] += each * Real((*column)[i]);
  }
  return costs;
}

std::vector<Real> Prices::hit_costs(const Record& record) const {
  const Hits& hits = *record.hits;
  const std::size_t n = hits.iteration.size();
  std::vector<Real> costs(n, 0), curve;
  const bool is_read_off = are_measured() && hits.counts.empty();
  if (is_read_off) curve = curve_costs(record);
  for (std::size_t kind = 0; kind < kOracles && are_measured(); ++kind) {
    const auto* column = column_of(hits.counts, kind);
    const Real each = price(record, kind);
    for (std::size_t j = 0; column != nullptr && j < std::min(n, column->size()); ++j)
      costs[j] += each * Real((*column)[j]);
  }
  for (std::size_t j = 0; j < n; ++j) {
    if (hits.iteration[j] < 0)
      costs[j] = kNever;
    else if (!are_measured() || (is_read_off && curve.empty()))
      costs[j] = Real(hits.work[j]);
    else if (is_read_off)
      costs[j] = between(record.curve.work, curve, Real(hits.work[j]));
  }
  return costs;
}

OracleCounts counts_at(const Record& record, Real work) {
  OracleCounts counts{};
  const auto read = [&](const Columns& columns, const std::vector<std::int64_t>& works) {
    const auto at =
        std::ranges::find_if(works, [&](std::int64_t each) { return Real(each) >= work; });
    const auto i = static_cast<std::size_t>(at - works.begin());
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      if (const auto* column = column_of(columns, kind); column && i < column->size())
        counts[kind] = (*column)[i];
  };
  if (record.hits && !record.hits->counts.empty())
    read(record.hits->counts, record.hits->work);
  else
    read(record.curve.counts, record.curve.work);
  return counts;
}

}  // namespace isoline::reports
