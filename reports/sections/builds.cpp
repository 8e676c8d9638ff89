// Where the results come from: builds, machines, commands.
#include <fmt/format.h>

#include <algorithm>
#include <ranges>
#include <set>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kMostBuilds = 8;

// What is told of a build, in order; equal ones are told once.
using Lines = std::vector<std::string>;
const std::vector<std::string> kTerms = {"version",      "commit",    "compiler", "build",
                                         "instructions", "processor", "system",   "libraries"};

Lines lines_of(const Build& build) {
  std::vector<std::string> libraries;
  for (const auto& [name, version] : build.libraries)
    libraries.push_back(fmt::format("{} {}", name, version));
  const bool is_changed = build.is_dirty.value_or(false) && !build.commit.empty();
  return {build.version,
          build.commit + (is_changed ? " with uncommitted changes" : ""),
          build.compiler + " " + build.flags,
          build.build_type,
          build.instruction_set,
          build.processor + (build.cores > 0 ? fmt::format(", {} cores", build.cores) : ""),
          build.system,
          joined(libraries)};
}

struct Origins {
  std::set<Lines> builds;
  std::set<std::string> commands;
};

Origins origins_of(const Comparison& c) {
  Origins all;
  std::set<const Build*> seen;  // one in memory for records of one build
  for (const Run& run : c.runs) {
    const Provenance& provenance = run.record->provenance;
    const bool is_new = seen.insert(provenance.build.get()).second;
    if (is_new && all.builds.size() < kMostBuilds) all.builds.insert(lines_of(*provenance.build));
    if (all.commands.size() < kMostBuilds) all.commands.insert(provenance.run.command);
  }
  all.commands.erase("");
  return all;
}

// A column a build, so that what differs stands side by side.
Table builds_table(const std::set<Lines>& builds) {
  Table table{.id = "builds", .columns = {""}, .align = "l" + std::string(builds.size(), 'p')};
  for (std::size_t i = 0; i < builds.size(); ++i)
    table.columns.push_back(builds.size() == 1 ? "build" : fmt::format("build {}", i + 1));
  for (std::size_t line = 0; line < kTerms.size(); ++line) {
    std::vector<TableCell> row = {kTerms[line]};
    for (const Lines& build : builds) row.emplace_back(build[line]);
    const bool is_told = std::ranges::any_of(
        row | std::views::drop(1), [](const TableCell& cell) { return !cell.text.empty(); });
    if (is_told) table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Section builds_section(const Comparison& c) {
  Section section{.id = "provenance", .title = "Provenance"};
  if (c.runs.empty()) return section;
  const Origins origins = origins_of(c);
  section.tables.push_back(builds_table(origins.builds));
  for (const std::string& command : origins.commands)
    section.readings.push_back({"Asked for by", command});
  section.readings.push_back({"One cell again", rerun_command(c.runs[0].record->request)});
  section.readings.push_back(
      {"The command of every other cell",
       "All cells of the page, button copy, or column command of report.csv"});
  return section;
}

}  // namespace isoline::reports
