// Runs that went wrong, and files that are no records: nothing vanishes in silence.
#include <fmt/format.h>

#include <filesystem>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

Section failures_section(const Comparison& c) {
  const auto& unreadable = c.study->unreadable;
  Section section{.id = "failures",
                  .title = "Failures",
                  .otherwise = "None: every run ended by a verdict of its own."};
  if (c.failures.empty() && unreadable.empty()) return section;
  section.title = fmt::format("Failures: {}, {}", counted(c.failures.size(), "run"),
                              counted(unreadable.size(), "unreadable file"));
  Table table{.id = "failures-table",
              .columns = {"problem", "optimizer", "seed", "status", "message", "rerun"},
              .align = "llrlpc",
              .names = 2};
  for (const std::size_t index : c.failures) {
    const Run& run = c.runs[index];
    const Record& record = *run.record;
    table.rows.push_back({record.request.problem.spec, record.request.optimizer.spec,
                          std::to_string(record.request.seed), std::string(name_of(record.status)),
                          record.message, rerun_command(record.request)});
    table.row_topics.push_back({.optimizer = run.optimizer, .problem = run.problem});
  }
  for (const Unreadable& file : unreadable)
    table.rows.push_back({std::filesystem::path(file.file).filename().string(), "", "",
                          "unreadable", file.reason, ""});
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace isoline::reports
