// Who solves the problems: the verdict, and the standings of all optimizers.
#include <fmt/format.h>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

Section standings_section(const Comparison& c) {
  Section section{.id = "standings", .title = "Who solves the problems to 1e-6"};
  for (std::string& sentence : verdict(c)) section.readings.push_back({"", std::move(sentence)});
  Table table{
      .id = "standings-table",
      .caption =
          "Ranked by their performance profiles. Solved: problems whose median run gets there, of "
          "those given to the optimizer. Best on: with the least work of all. × least work: median "
          "over problems; ✗ if it solves fewer than half. Runs: that get there. Failed: errors, "
          "crashes, time or memory limits. †: sees what others do not.",
      .columns = {"", "optimizer", "solved", "best on", "× least work", "runs", "failed"},
      .align = "rlrrrrr",
      .names = 2};
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const OptimizerAxis& optimizer = c.optimizers[s];
    const Standing& standing = optimizer.tightest();
    table.rows.push_back(
        {std::to_string(s + 1), optimizer_text(c, s),
         fmt::format("{}/{}", standing.solved, optimizer.planned), std::to_string(standing.wins),
         standing.typical == kNever ? "✗" : fmt::format("{:.3g}", standing.typical),
         fmt::format("{}/{}", standing.reached, optimizer.runs), std::to_string(optimizer.failed)});
    table.row_topics.push_back({.optimizer = s});
  }
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace isoline::reports
