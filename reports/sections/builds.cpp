// Where the results come from: builds, machines, commands.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
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

// Text of any JSON value, "" where there is none.
std::string text_at(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  if (!json.is_object() || at == json.end()) return "";
  return at->is_string() ? at->get<std::string>() : at->dump();
}

std::string libraries_of(const Json& provenance) {
  std::string text;
  const auto libraries = provenance.find("libraries");
  if (libraries == provenance.end() || !libraries->is_object()) return text;
  for (const auto& [name, version] : libraries->items())
    text +=
        fmt::format("{}{} {}", text.empty() ? "" : ", ", name, text_at(*libraries, name.c_str()));
  return text;
}

Lines lines_of(const Json& provenance) {
  const std::string commit = text_at(provenance, "commit"), cores = text_at(provenance, "cores");
  const bool is_dirty = text_at(provenance, "dirty") == "true";
  return {text_at(provenance, "version"),
          commit.empty() || !is_dirty ? commit : commit + " with uncommitted changes",
          text_at(provenance, "compiler") + " " + text_at(provenance, "flags"),
          text_at(provenance, "build_type"),
          text_at(provenance, "instruction_set"),
          text_at(provenance, "processor") + (cores.empty() ? "" : ", " + cores + " cores"),
          text_at(provenance, "system"),
          libraries_of(provenance)};
}

struct Origins {
  std::set<Lines> builds;
  std::set<std::string> commands;
};

Origins origins_of(const Comparison& c) {
  Origins all;
  std::set<const Json*> seen;
  for (const Run& run : c.runs) {
    const Provenance& provenance = run.record->provenance;
    const Json* version = provenance.find("version");  // one in memory for records of one build
    const bool is_new = version == nullptr || seen.insert(version).second;
    if (is_new && all.builds.size() < kMostBuilds) all.builds.insert(lines_of(provenance));
    if (provenance.is_object() && provenance.contains("run") && all.commands.size() < kMostBuilds)
      all.commands.insert(text_at(provenance["run"], "command"));
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
