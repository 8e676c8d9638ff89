// Tables of profiles: of two methods alone, without one, by work, and by digits.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "reports/read/grounds.h"
#include "reports/read/orders.h"
#include "reports/sections/evidence.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/words.h"
#include "reports/statistics/runtimes.h"

namespace isoline::reports {
namespace {

// The order of the optimizers by score, without one of them; nothing left out where `without` is k.
std::vector<Real> scores_without(const Comparison& c, Costs costs, std::size_t without) {
  for (auto& row : costs)
    if (without < row.size()) row[without].reset();
  const Profile profile = performance_profile(costs);
  std::vector<Real> scores;
  for (const std::size_t s : c.order.methods)
    scores.push_back(s < profile.solvers.size() ? profile.area(s, kProfileEnd) : 0);
  return scores;
}

std::size_t first_of(const std::vector<Real>& scores, std::size_t without) {
  std::size_t best = without == 0 && scores.size() > 1 ? 1 : 0;
  for (std::size_t s = 0; s < scores.size(); ++s)
    if (s != without && scores[s] > scores[best]) best = s;
  return best;
}

// Costs of two alone.
std::array<Real, 2> pair_scores(const Costs& costs, std::size_t a, std::size_t b, std::size_t& n) {
  Costs pair;
  for (const auto& row : costs)
    if (row[a] && row[b]) pair.push_back({row[a], row[b]});
  n = pair.size();
  if (pair.empty()) return {0, 0};
  const Profile profile = performance_profile(pair);
  return {profile.area(0, kProfileEnd), profile.area(1, kProfileEnd)};
}

}  // namespace

Table pairwise_table(const Comparison& c) {
  const std::size_t k = shown_optimizers(c, kMostTablePairs);
  const Costs costs = common_costs(c, kTightest);
  Table table{
      .id = "pairwise",
      .title = "Pairwise profiles",
      .reading = "",
      .caption =
          "Profiles of two methods alone, on the settings given to both: the area of the row's "
          "profile up to 64 times the least, and the column's. No third method can swap such a pair.",
      .columns = {"optimizer"},
      .rows = {}};
  std::size_t turned = 0, pairs = 0;
  for (std::size_t a = 0; a < k; ++a) table.columns.push_back(optimizer_text(c, a));
  for (std::size_t a = 0; a < k; ++a) {
    std::vector<TableCell> row = {optimizer_text(c, a)};
    for (std::size_t b = 0; b < k; ++b) {
      std::size_t n = 0;
      const auto [mine, other] = pair_scores(costs, a, b, n);
      row.push_back(a == b ? TableCell("")
                           : TableCell(fmt::format("{:.2f} : {:.2f} (n {})", mine, other, n),
                                       {{"area", mine}, {"other_area", other}, {"n", Real(n)}}));
      pairs += b > a;
      turned += b > a && other > mine;
    }
    row.push_back(failed_cell(c, a));
    table.rows.push_back(std::move(row));
  }
  table.columns.push_back("failed");
  rows_are_optimizers(table);
  columns_are_optimizers(table, k);
  table.reading =
      fmt::format("Of {} pairs among the first {}, {} are in the other order when compared alone.",
                  pairs, k, turned);
  return table;
}

Table flip_table(const Comparison& c) {
  const std::size_t k = c.order.methods.size();
  const Costs costs = common_costs(c, kTightest);
  const std::vector<Real> all = scores_without(c, costs, k);
  Table table{
      .id = "flips",
      .title = "Removing one optimizer",
      .reading = "",
      .caption =
          "With more than two methods a profile's order depends on who else is there (Gould, "
          "Scott 2016). Each method whose removal swaps two others: how many pairs it swaps, and which method is then first.",
      .columns = {"left out", "pairs swapped", "first without it", "failed"},
      .rows = {}};
  std::size_t turning = 0;
  for (std::size_t out = 0; out < k; ++out) {
    const std::vector<Real> scores = scores_without(c, costs, out);
    std::size_t flips = 0;
    for (std::size_t a = 0; a < k; ++a)
      for (std::size_t b = a + 1; b < k; ++b)
        flips += a != out && b != out && (all[a] - all[b]) * (scores[a] - scores[b]) < 0;
    turning += flips > 0;
    if (flips == 0 || table.rows.size() >= kMostTableRows) continue;
    table.row_topics.push_back({.optimizer = out});
    table.rows.push_back({optimizer_text(c, out), count_cell(flips),
                          optimizer_text(c, first_of(scores, out)), failed_cell(c, out)});
  }
  const std::size_t first = first_of(all, k);
  table.reading =
      fmt::format("For {} of {}, removing it swaps another pair; with all of them {} is first.",
                  turning, counted(k, "method"), k == 0 ? "none" : optimizer_text(c, first));
  return table;
}

Table data_profile_table(const Comparison& c) {
  constexpr std::array<int, 5> kWork = {10, 100, 1000, 10'000, 100'000};
  Table table{
      .id = "data-profile",
      .title = "Data profile",
      .reading = "",
      .caption = fmt::format(
          "Share of the {}s given to a method that its median run solves to {} within so many {}; "
          "unsolved, inapplicable and missing ones stay in n.",
          setting_noun(c), tau_name(c), cost_unit(c)),
      .columns = {"optimizer"},
      .rows = {}};
  for (const int work : kWork) table.columns.push_back(fmt::format("≤ {}", work));
  for (const std::string& column : std::vector<std::string>{"at all", n_column(c), "failed"})
    table.columns.push_back(column);
  const Measure by = cost_measure(c);
  Leading first;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    std::vector<TableCell> row = {optimizer_text(c, s)};
    const std::size_t n = c.order.settings.size();
    for (const Real work : {Real(kWork[0]), Real(kWork[1]), Real(kWork[2]), Real(kWork[3]),
                            Real(kWork[4]), std::numeric_limits<Real>::max()}) {
      std::size_t within = 0;
      for (const std::size_t p : c.order.settings)
        within += in_units(by, c.cell(p, s).taken[by][kTightest].median) <= work;
      row.push_back(share_cell(within, n));
      if (work == kWork[2] && n > 0) first.offer(Real(within) / Real(n), optimizer_text(c, s));
    }
    row.push_back(count_cell(n));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading = fmt::format("The largest share within 1000 {}: {} ({}).", unit_name(by),
                              first.names(), percent(first.value));
  return table;
}

Table accuracy_table(const Comparison& c) {
  constexpr std::array<int, 4> kDigits = {1, 3, 6, 10};
  Table table{
      .id = "accuracy",
      .title = "Accuracy profile",
      .reading = "",
      .caption =
          "Digits of the loss gained within the budget, −log10 of the relative loss gap at the "
          "best point seen, median over seeds: share of the settings with at least so many, and "
          "the median. No more than the target at which a run is stopped: what lies beyond is "
          "overshoot of its last step. A failed run gains none.",
      .columns = {"optimizer"},
      .rows = {}};
  for (const int digits : kDigits) table.columns.push_back(fmt::format("≥ {}", digits));
  for (const std::string& column : std::vector<std::string>{"median", n_column(c), "failed"})
    table.columns.push_back(column);
  Leading first;
  for (std::size_t s = 0; s < shown_optimizers(c, kMostTableRows); ++s) {
    const std::vector<Real> lacking = lacking_digits(c, s, &Summary::best_loss);
    std::vector<TableCell> row = {optimizer_text(c, s)};
    for (const int digits : kDigits)
      row.push_back(
          share_cell(static_cast<std::size_t>(std::ranges::count_if(
                         lacking, [digits](Real value) { return -value >= Real(digits); })),
                     lacking.size()));
    const Real median = -median_of(lacking);
    if (median > -kNever) first.offer(median, optimizer_text(c, s));
    row.push_back(digits_cell(median));
    row.push_back(count_cell(lacking.size()));
    row.push_back(failed_cell(c, s));
    table.rows.push_back(std::move(row));
  }
  rows_are_optimizers(table);
  table.reading = first.count == 0
                      ? "No method gains a digit in the median over settings."
                      : fmt::format("Most digits in the median over settings: {:.3g}, by {}.",
                                    first.value, first.names());
  return table;
}

}  // namespace isoline::reports
