// The statistics of a report as tables: computed and worded once, so that every format prints the
// same figures. Orders of optimizers are by declared work, which any machine repeats; what runs
// cost is in equivalent forward solves, with raw counts beside.
#pragma once

#include <string>
#include <vector>

#include "reports/comparison.h"

namespace isoline::reports {

// In the order of a report; empty where nothing has run.
std::vector<StatisticTable> statistic_tables(const Comparison& comparison);

// What so few problems, seeds or runs cannot show, a sentence each.
std::vector<std::string> limits_of_evidence(const Comparison& comparison);

// One each.
StatisticTable accuracy_table(const Comparison& comparison);
StatisticTable anytime_table(const Comparison& comparison);
StatisticTable calls_table(const Comparison& comparison);
StatisticTable data_profile_table(const Comparison& comparison);
StatisticTable flip_table(const Comparison& comparison);
StatisticTable interval_table(const Comparison& comparison);
StatisticTable pairwise_table(const Comparison& comparison);
StatisticTable prices_table(const Comparison& comparison);
StatisticTable profile_table(const Comparison& comparison);
StatisticTable rank_table(const Comparison& comparison);
StatisticTable restart_table(const Comparison& comparison);
StatisticTable returned_table(const Comparison& comparison);
StatisticTable signed_rank_table(const Comparison& comparison);

inline constexpr std::size_t kMostTableRows = 40;   // the best optimizers
inline constexpr std::size_t kMostTablePairs = 10;  // the best of them against each other

// What the tables share.
std::size_t shown_optimizers(const Comparison& comparison, std::size_t most);
std::string optimizer_text(const Comparison& comparison, std::size_t optimizer);  // "sip †"
// The i-th row is of the i-th optimizer.
void rows_are_optimizers(StatisticTable& table);
// The first columns beside the names are of the first optimizers, or problems.
void columns_are_optimizers(StatisticTable& table, std::size_t count);
void columns_are_problems(StatisticTable& table, std::size_t count);
TableCell failed_cell(const Comparison& comparison, std::size_t optimizer);  // "2/80"
TableCell count_cell(std::size_t count);
TableCell digits_cell(Real digits);                         // ✗ where there are none
TableCell share_cell(std::size_t part, std::size_t whole);  // "33 %"
// "forward solves at measured prices", or what else the costs of this comparison are.
std::string cost_unit(const Comparison& comparison);

}  // namespace isoline::reports
