// The same methods at the rates of tables and at their defaults: what tuning changed where it
// counts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/sections/evidence.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// One method at rates of a table and at its defaults, on the settings given to both.
struct SideBySide {
  std::size_t tuned = 0, plain = 0;  // optimizers
  std::size_t n = 0, solved = 0, solved_plain = 0, wins = 0, losses = 0;
  std::vector<Real> doublings;  // log2 of tuned over plain where one solves; capped as profiles are
};

const Request& request_of(const Comparison& c, const Cell& cell) {
  return c.runs[cell.runs.front()].record->request;
}

bool has_rates(const Comparison& c, std::size_t s) {
  return std::ranges::any_of(c.cells, [&](const auto& row) {
    const Cell& cell = row[s];
    return cell.is_measured() && !request_of(c, cell).rates.empty() &&
           request_of(c, cell).optimizer.spec != request_of(c, cell).optimizer.name;
  });
}

bool is_at_defaults(const Comparison& c, std::size_t s) {
  return std::ranges::all_of(c.cells, [&](const auto& row) {
    const Cell& cell = row[s];
    return !cell.is_measured() ||
           request_of(c, cell).optimizer.spec == request_of(c, cell).optimizer.name;
  });
}

SideBySide compared(const Comparison& c, std::size_t tuned, std::size_t plain) {
  const Costs costs = median_costs(c, kTightest);
  SideBySide pair{.tuned = tuned, .plain = plain, .doublings = {}};
  const Real most = std::log2(kProfileEnd);
  for (const auto& row : costs) {
    if (!row[tuned] || !row[plain]) continue;
    ++pair.n;
    pair.solved += *row[tuned] < kNever;
    pair.solved_plain += *row[plain] < kNever;
    pair.wins += *row[tuned] < *row[plain];
    pair.losses += *row[plain] < *row[tuned];
    if (*row[tuned] == kNever && *row[plain] == kNever) continue;
    const Real ratio =
        std::log2(std::max(*row[tuned], 1.0)) - std::log2(std::max(*row[plain], 1.0));
    pair.doublings.push_back(std::clamp(ratio, -most, most));
  }
  return pair;
}

std::vector<SideBySide> pairs_of(const Comparison& c) {
  std::vector<SideBySide> pairs;
  for (std::size_t a = 0; a < c.optimizers.size(); ++a)
    for (std::size_t b = 0; b < c.optimizers.size(); ++b)
      if (a != b && c.optimizers[a].method == c.optimizers[b].method && has_rates(c, a) &&
          is_at_defaults(c, b))
        if (SideBySide pair = compared(c, a, b); pair.n > 0) pairs.push_back(std::move(pair));
  return pairs;
}

std::string factor_text(Real doublings) {
  const Real edge = std::log2(kProfileEnd);
  if (std::abs(doublings) >= edge) return doublings < 0 ? "≤ 1/64" : "≥ 64";
  return fmt::format("{:.2g}", std::exp2(doublings));
}

}  // namespace

Table tuned_and_defaults_table(const Comparison& c) {
  const std::vector<SideBySide> pairs = pairs_of(c);
  Table table{.id = "tuned-and-defaults",
              .title = "Defaults and tuned, side by side",
              .reading = "",
              .caption = fmt::format(
                  "The same method at the rates of tables and at its defaults, on the {}s given "
                  "both ways: how many each solves to {}, on how many tuned needs less {} and on "
                  "how many more, and tuned over default, 2 to the median of the logarithms of "
                  "these ratios where one of the two solves.",
                  setting_noun(c), tau_name(c), counted_name(c)),
              .columns = {"optimizer", n_column(c), "solved, tuned", "solved, defaults",
                          "less : more", "tuned over default"}};
  for (const SideBySide& pair : pairs) {
    const Real middle = median_of(pair.doublings);
    table.rows.push_back(
        {c.optimizers[pair.plain].method, count_cell(pair.n), count_cell(pair.solved),
         count_cell(pair.solved_plain), fmt::format("{} : {}", pair.wins, pair.losses),
         pair.doublings.empty() ? TableCell("")
                                : TableCell(factor_text(middle), {{"doublings", middle}})});
    table.row_topics.push_back({.method = c.optimizers[pair.plain].method});
  }
  const auto better = std::ranges::count_if(
      pairs, [](const SideBySide& pair) { return pair.solved > pair.solved_plain; });
  const auto worse = std::ranges::count_if(
      pairs, [](const SideBySide& pair) { return pair.solved < pair.solved_plain; });
  table.reading = fmt::format(
      "Tuned, {} of {} methods solve more {}s than at their defaults, and {} solve fewer.", better,
      pairs.size(), setting_noun(c), worse);
  return table;
}

}  // namespace isoline::reports
