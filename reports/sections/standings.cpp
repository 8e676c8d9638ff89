// Who solves the problems: the verdict, the standings of the common order, and who stands apart.
#include <fmt/format.h>

#include "reports/read/grounds.h"
#include "reports/sections/leading.h"
#include "reports/sections/measure_words.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string typical_text(const Standing& standing) {
  return standing.typical == kNever ? "✗" : fmt::format("{:.3g}", standing.typical);
}

std::vector<TableCell> standing_row(const Comparison& c, const std::string& place, std::size_t s) {
  const OptimizerAxis& optimizer = c.optimizers[s];
  const Standing& standing = optimizer.tightest();
  std::vector<TableCell> row = {place,
                                optimizer_text(c, s),
                                fmt::format("{}/{}", standing.solved, standing.settings),
                                std::to_string(standing.wins),
                                typical_text(standing),
                                fmt::format("{}/{}", standing.reached, standing.runs),
                                std::to_string(optimizer.failed)};
  for (std::size_t t = kTightest; t-- > 0;)
    row.push_back(std::to_string(optimizer.standings[t].solved));
  return row;
}

Table standings_table(const Comparison& c) {
  const std::string legend = foreign_legend(c);
  Table table{
      .id = "standings-table",
      .caption = fmt::format(
          "Methods given the same {}, ranked by their performance profiles; equal scores share a "
          "place. Solved: {}s whose median run reaches the tolerance. Best on: with the least {} of these "
          "methods. × least: the middle of its {} over the least, in logarithms; ✗ if it solves "
          "fewer than half. Runs: those that reach it. Failed: errors, crashes, time or memory limits, "
          "on all that it was given. †: uses privileged information.{}",
          counted(c.order.settings.size(), common_noun(c)), common_noun(c), counted_name(c),
          counted_name(c), legend.empty() ? "" : " " + legend),
      .columns = {"", "optimizer", "solved", "best on", "× least", "runs", "failed"},
      .align = "rlrrrrrrr",
      .names = 2};
  for (std::size_t t = kTightest; t-- > 0;)
    table.columns.push_back(fmt::format("to {}", c.yardstick.tolerances[t].name));
  std::size_t place = 0;
  for (std::size_t i = 0; i < c.order.methods.size(); ++i) {
    const std::size_t s = c.order.methods[i];
    const Real score = c.optimizers[s].tightest().score;
    const bool is_tied =
        i > 0 && are_tied(score, c.optimizers[c.order.methods[i - 1]].tightest().score);
    if (!is_tied) place = i + 1;
    table.rows.push_back(standing_row(c, std::to_string(place), s));
    table.row_topics.push_back({.optimizer = s});
  }
  return table;
}

Table apart_table(const Comparison& c) {
  Table table{.id = "apart-table",
              .title = "Not ranked with the others",
              .caption =
                  "Each against the ranked methods, on those of its settings that all of "
                  "these were given.",
              .columns = {"optimizer", "why", "where it would stand", "solved", "best on"},
              .align = "lllrr"};
  for (const Placed& placed : c.apart) {
    const Standing& standing = c.optimizers[placed.optimizer].tightest();
    table.rows.push_back(
        {optimizer_text(c, placed.optimizer), apart_text(c, placed), placed_text(c, placed),
         fmt::format("{}/{}", standing.solved, standing.settings), std::to_string(standing.wins)});
    table.row_topics.push_back({.optimizer = placed.optimizer});
  }
  return table;
}

// The first of an order, and the next two.
std::string podium_text(const Comparison& c, const Order& order) {
  const std::vector<Scored> ranked = ranked_by(costs_within(c, order, kTightest, c.yardstick.by));
  constexpr std::size_t kPodium = 3;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < ranked.size() && i < kPodium && ranked[i].score > 0; ++i)
    names.push_back(fmt::format("{} ({}/{})", optimizer_text(c, ranked[i].optimizer),
                                ranked[i].solved, ranked[i].problems));
  return names.empty() ? "none solves any" : joined(names);
}

Table orders_table(const Comparison& c) {
  Table table{.id = "orders-table",
              .title = "Settings that only some methods were given",
              .caption =
                  "Each line compares the methods that were given exactly these settings: an "
                  "order of its own, over too few problems for a verdict.",
              .columns = {"settings", "methods", "first by score (solved)"},
              .align = "lrl"};
  for (const Order& order : c.other_orders) {
    std::vector<std::string> settings;
    for (const std::size_t p : order.settings) settings.push_back(problem_name(c.problems[p]));
    table.rows.push_back(
        {joined(settings), std::to_string(order.methods.size()), podium_text(c, order)});
  }
  return table;
}

}  // namespace

Section standings_section(const Comparison& c) {
  Section section{.id = "standings",
                  .title = fmt::format("Who solves the problems to {}", tau_name(c))};
  for (std::string& sentence : verdict(c)) section.readings.push_back({"", std::move(sentence)});
  if (!c.order.settings.empty()) section.tables.push_back(standings_table(c));
  if (!c.apart.empty()) section.tables.push_back(apart_table(c));
  if (!c.other_orders.empty()) section.tables.push_back(orders_table(c));
  return section;
}

}  // namespace isoline::reports
