// Reads learned runs where all have spent the same.
#include "reports/read/equal_work.h"

#include <algorithm>
#include <cmath>

namespace isoline::reports {
namespace {

Real median_spent(const Comparison& c, const Cell& cell) {
  std::vector<Real> spent;
  for (const std::size_t run : cell.runs)
    if (const Summary& summary = c.runs[run].record->summary; summary.work > 0)
      spent.push_back(Real(summary.work));
  return median_of(std::move(spent));
}

Real value_at(const Record& record, const std::vector<Real>& column, Real work) {
  const auto& spent = record.curve.work;
  const auto passed = static_cast<std::size_t>(
      std::ranges::upper_bound(spent, static_cast<std::int64_t>(work)) - spent.begin());
  const bool has_ended = passed == spent.size() && is_failure(record.status);
  if (passed == 0 || passed > column.size() || has_ended) return kNever;
  return column[passed - 1];
}

AtEqualWork read_at(const Comparison& c, const Cell& cell, Real work) {
  std::vector<Real> x_errors, losses;
  for (const std::size_t run : cell.runs) {
    const Record& record = *c.runs[run].record;
    x_errors.push_back(value_at(record, record.curve.x_error, work));
    losses.push_back(value_at(record, record.curve.loss, work));
  }
  return {spread_of(std::move(x_errors)), spread_of(std::move(losses))};
}

}  // namespace

std::vector<std::size_t> EqualWork::nearest_first() const {
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < methods.size(); ++s)
    if (methods[s]) order.push_back(s);
  std::ranges::stable_sort(order, {}, [&](std::size_t s) { return methods[s]->x_error.median; });
  return order;
}

Real EqualWork::least_x_error() const {
  Real least = kNever;
  for (const auto& method : methods)
    if (method) least = std::min(least, method->x_error.median);
  return least;
}

EqualWork equal_work(const Comparison& c, std::size_t problem) {
  EqualWork all{.work = kNever, .methods = {}};
  for (const Cell& cell : c.cells[problem])
    if (cell.is_measured()) all.work = std::min(all.work, median_spent(c, cell));
  for (const Cell& cell : c.cells[problem])
    all.methods.push_back(cell.is_measured() ? std::optional(read_at(c, cell, all.work))
                                             : std::nullopt);
  return all;
}

}  // namespace isoline::reports
