// Where the results come from: builds, machines, commands; runs that failed, and unreadable files.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "core/seeds.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// The reported parts of a build, in order; equal ones once.
constexpr std::array<const char*, 8> kTerms = {
    "version", "commit", "compiler", "build", "instructions", "processor", "system", "libraries"};
using Lines = std::array<std::string, kTerms.size()>;

Lines lines_of(const Build& build) {
  std::vector<std::string> libraries;
  for (const auto& [name, version] : build.libraries) libraries.push_back(name + " " + version);
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

}  // namespace

std::string version_text(const Comparison& c) {
  constexpr std::size_t kShort = 7, kMost = 3;
  std::set<std::string> programs;
  for (const Run& run : c.runs) {
    if (run.record->imported) continue;
    const Build& build = *run.record->provenance.build;
    programs.insert("Isoline " + build.version +
                    (build.commit.empty() ? "" : " (" + build.commit.substr(0, kShort) + ")"));
  }
  return programs.size() > kMost ? counted(programs.size(), "version") + " of Isoline"
                                 : joined({programs.begin(), programs.end()});
}

Section builds_section(const Comparison& c) {
  constexpr std::size_t kMost = 8;  // builds, and commands
  Section section = worded_section("provenance");
  if (c.runs.empty()) return section;
  std::set<Lines> builds;
  std::set<std::string> commands;
  std::set<const Build*> seen;  // one in memory for records of one build
  for (const Run& run : c.runs) {
    const Provenance& provenance = run.record->provenance;
    if (seen.insert(provenance.build.get()).second && builds.size() < kMost)
      builds.insert(lines_of(*provenance.build));
    if (commands.size() < kMost) commands.insert(provenance.run.command);
  }
  commands.erase("");
  // A column a build, so that what differs stands side by side.
  Table& table = section.tables.emplace_back(
      Table{.id = "builds", .columns = {"what"}, .align = "l" + std::string(builds.size(), 'p')});
  for (std::size_t i = 0; i < builds.size(); ++i)
    table.columns.push_back(builds.size() == 1 ? "build" : fmt::format("build {}", i + 1));
  for (std::size_t term = 0; term < kTerms.size(); ++term) {
    std::vector<TableCell> row = {kTerms[term]};
    for (const Lines& build : builds) row.emplace_back(build[term]);
    const auto is_known = [&](const Lines& build) { return !build[term].empty(); };
    if (std::ranges::any_of(builds, is_known)) table.rows.push_back(std::move(row));
  }
  for (const std::string& command : commands) section.readings.push_back({"Requested by", command});
  section.readings.push_back({"Repeat one cell", rerun_command(c.runs[0].record->request)});
  section.readings.push_back({"Repeat any cell", words("provenance.commands")});
  return section;
}

// Nothing vanishes in silence.
Section failures_section(const Comparison& c) {
  const auto& unreadable = c.study->unreadable;
  Section section = worded_section("failures");
  if (c.failures.empty() && unreadable.empty()) return section;
  section.title = words("failures.counted", c.failures.size(), unreadable.size());
  Table table = worded_table("failures-table");
  table.names = 2;
  for (const std::size_t index : c.failures) {
    const Run& run = c.runs[index];
    const Record& record = *run.record;
    table.rows.push_back({record.request.problem.spec, record.request.optimizer.spec,
                          seed_text(record.request.seed), std::string(name_of(record.status)),
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
