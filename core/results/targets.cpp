// Reads what each target took off the hits of a record, or else off its curve, at its prices.
#include "core/results/targets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace isoline::results {
namespace {

// "1e-4", "1.6e-4": two digits tell a rung from its neighbours.
std::string rung_name(std::size_t j) {
  if (j == 0) return "1";
  std::string text = fmt::format("{:.1e}", rung(j));
  if (const std::size_t zero = text.find(".0"); zero != std::string::npos) text.erase(zero, 2);
  if (const std::size_t zero = text.find("e-0"); zero != std::string::npos) text.erase(zero + 2, 1);
  return text;
}

Tolerance tolerance_of_rung(std::size_t j) {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (std::size_t each = 0; each < kRungs; ++each) all.push_back(rung_name(each));
    return all;
  }();
  return {names[j], rung(j), j};
}

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

BestKnown::BestKnown(const Study& study) {
  for (const Record& record : study.runs) {
    if (record.imported) continue;  // imported values change no other run's targets
    const auto key = std::pair(record.request.problem.spec, record.request.seed);
    Real& least = least_.emplace(key, kNever).first->second;
    const Real best = record.summary.best_loss;
    if (record.status != Status::inapplicable && best < least) least = best;
  }
}

Real BestKnown::minimum(const Record& record) const {
  if (record.minimum) return *record.minimum;
  const auto found = least_.find({record.request.problem.spec, record.request.seed});
  if (found != least_.end()) return found->second;
  return record.imported ? record.summary.best_loss : std::nan("");
}

Real Reached::by(Measure measure) const {
  switch (measure) {
    case Measure::work:
      return work;
    case Measure::cost:
      return cost;
    case Measure::iterations:
      return Real(iteration);
    case Measure::time:
      return seconds;
  }
  return kNever;
}

namespace {

std::vector<Reached> from_hits(const Record& record, const Prices& prices) {
  const Hits& hits = *record.hits;
  const std::vector<Real> costs = prices.hit_costs(record);
  std::vector<Reached> met;
  for (std::size_t j = 0; j < hits.iteration.size() && hits.iteration[j] >= 0; ++j)
    met.push_back({Real(hits.work[j]), costs[j], hits.wall_seconds[j],
                   static_cast<std::int32_t>(hits.iteration[j])});
  return met;
}

// At the first kept points where left[i] ≤ goal(j).
template <class Goal>
std::vector<Reached> from_curve(const Record& record, const Prices& prices,
                                const std::vector<Real>& left, Goal goal) {
  const Curve& curve = record.curve;
  const std::vector<Real> costs = prices.curve_costs(record);
  std::vector<Reached> met;
  std::size_t i = 0;
  for (std::size_t j = 0; j < kTargets; ++j) {
    while (i < left.size() && !(left[i] <= goal(j))) ++i;
    if (i == left.size()) break;
    met.push_back({Real(curve.work[i]), costs[i], curve.wall_seconds[i],
                   static_cast<std::int32_t>(curve.iteration[i]),
                   i > 0 && curve.iteration[i] > curve.iteration[i - 1] + 1});
  }
  return met;
}

}  // namespace

std::vector<Reached> targets_met(const Record& record, const Prices& prices, Aim aim,
                                 const BestKnown& best) {
  if (record.status == Status::inapplicable) return {};
  if (aim == Aim::x) {
    if (!record.x_scale) return {};
    return from_curve(record, prices, record.curve.x_error, [&](std::size_t j) {
      return x_goal(rung(j), *record.x_scale, record.x_floor);
    });
  }
  if (record.hits) return from_hits(record, prices);
  const Real minimum = best.minimum(record), scale = best.scale(record);
  return from_curve(record, prices, record.curve.loss,
                    [&](std::size_t j) { return minimum + rung(j) * scale; });
}

}  // namespace isoline::results
