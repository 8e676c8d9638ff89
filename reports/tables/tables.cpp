// Gathers the tables of statistics and what they share.
#include "reports/tables/tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/text.h"

namespace isoline::reports {

std::size_t shown_optimizers(const Comparison& c, std::size_t most) {
  return std::min(c.optimizers.size(), most);
}

std::string optimizer_text(const Comparison& c, std::size_t s) {
  return shown_spec(c.optimizers[s].label) + (c.optimizers[s].privileges.empty() ? "" : " †");
}

void rows_are_optimizers(StatisticTable& table) {
  for (std::size_t s = 0; s < table.rows.size(); ++s)
    table.row_subjects.push_back({s, std::nullopt});
}

void columns_are_optimizers(StatisticTable& table, std::size_t count) {
  table.column_subjects.emplace_back();
  for (std::size_t s = 0; s < count; ++s) table.column_subjects.push_back({s, std::nullopt});
}

void columns_are_problems(StatisticTable& table, std::size_t count) {
  table.column_subjects.emplace_back();
  for (std::size_t p = 0; p < count; ++p) table.column_subjects.push_back({std::nullopt, p});
}

TableCell failed_cell(const Comparison& c, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  return {fmt::format("{}/{}", optimizer.failed, optimizer.runs),
          {{"failed", Real(optimizer.failed)}, {"runs", Real(optimizer.runs)}}};
}

TableCell count_cell(std::size_t count) {
  return {std::to_string(count), {{"count", Real(count)}}};
}

TableCell digits_cell(Real digits) {
  return {digits == -kNever ? "✗" : fmt::format("{:.3g}", digits + 0.0), {{"digits", digits}}};
}

TableCell share_cell(std::size_t part, std::size_t whole) {
  if (whole == 0) return "";
  const Real share = Real(part) / Real(whole);
  return {percent(share), {{"share", share}, {"count", Real(part)}}};
}

std::string cost_unit(const Comparison& c) {
  const auto measured = std::ranges::count_if(
      c.problems, [](const ProblemAxis& problem) { return problem.prices.are_measured(); });
  const auto all = static_cast<std::ptrdiff_t>(c.problems.size());
  if (measured == all) return "equivalent forward solves at measured prices";
  if (measured == 0) return "forward solves at declared prices (no measured ones are here)";
  return fmt::format(
      "equivalent forward solves, at declared prices on {} of {} problems that have "
      "no measured ones",
      all - measured, all);
}

std::vector<StatisticTable> statistic_tables(const Comparison& c) {
  if (c.runs.empty()) return {};
  return {profile_table(c), rank_table(c),     signed_rank_table(c), pairwise_table(c),
          flip_table(c),    returned_table(c), accuracy_table(c),    data_profile_table(c),
          anytime_table(c), interval_table(c), restart_table(c),     calls_table(c),
          prices_table(c)};
}

}  // namespace isoline::reports
