// Finds the rows of tables of rates by the records that used them.
#include "reports/sections/origins.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <ranges>
#include <set>

#include "core/spec.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

const Request* request_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  return cell.runs.empty() ? nullptr : &c.runs[cell.runs.front()].record->request;
}

// "3.8e-5" of gd[rate=3.8e-5], "rate=1, momentum=0.9" where there are several, "default" of gd.
std::string values_text(const Request& request) {
  const Spec spec = parse_spec(request.optimizer.spec);
  std::vector<std::string> shown;  // long numbers cut
  for (const auto& [name, value] : spec.options)
    shown.push_back(shown_spec(fmt::format("{}={}", name, value)));
  if (shown.empty()) return "default";
  return shown.size() > 1 ? joined(shown) : shown[0].substr(spec.options[0].first.size() + 1);
}

}  // namespace

const TunedRate* rate_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Request* request = request_of(c, p, s);
  if (request == nullptr || request->rates.empty()) return nullptr;
  for (const TunedRate& rate : c.study->rates)
    if (rate.problem == request->problem.spec && rate.optimizer == request->optimizer.name &&
        rate.file == request->rates)
      return &rate;
  return nullptr;
}

Origin origin_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Request* request = request_of(c, p, s);
  if (request == nullptr) return Origin::defaults;
  if (request->rates.empty())
    return request->optimizer.spec == request->optimizer.name ? Origin::defaults : Origin::given;
  const TunedRate* rate = rate_of(c, p, s);
  if (rate == nullptr) return Origin::table;
  return rate->is_tuned() ? Origin::tuned : Origin::published;
}

std::string origin_text(const Comparison& c, std::size_t p, std::size_t s) {
  const Origin origin = origin_of(c, p, s);
  if (origin == Origin::defaults || origin == Origin::given) return "";
  return fmt::format("{}, {}", values_text(*request_of(c, p, s)), name_of(origin));
}

std::string setting_text(const Comparison& c, std::size_t p, std::size_t s) {
  const std::string origin = origin_text(c, p, s);
  if (origin.empty()) return shown_spec(c.optimizers[s].label);
  return fmt::format("{} ({})", c.optimizers[s].method, origin);
}

// Where the results come from: builds, machines, commands.

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

// A column a build, so that what differs stands side by side.
Table builds_table(const std::set<Lines>& builds) {
  Table table{.id = "builds", .columns = {""}, .align = "l" + std::string(builds.size(), 'p')};
  for (std::size_t i = 0; i < builds.size(); ++i)
    table.columns.push_back(builds.size() == 1 ? "build" : fmt::format("build {}", i + 1));
  for (std::size_t term = 0; term < kTerms.size(); ++term) {
    std::vector<TableCell> row = {kTerms[term]};
    for (const Lines& build : builds) row.emplace_back(build[term]);
    const auto is_known = [](const TableCell& cell) { return !cell.text.empty(); };
    if (std::ranges::any_of(row | std::views::drop(1), is_known))
      table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Section builds_section(const Comparison& c) {
  constexpr std::size_t kMost = 8;  // builds, and commands
  Section section{.id = "provenance", .title = "Provenance"};
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
  section.tables.push_back(builds_table(builds));
  for (const std::string& command : commands) section.readings.push_back({"Asked for by", command});
  section.readings.push_back({"One cell again", rerun_command(c.runs[0].record->request)});
  section.readings.push_back(
      {"The command of every other cell",
       "All cells of the page, button copy, or column command of report.csv"});
  return section;
}

// Runs that went wrong, and files that are no records: nothing vanishes in silence.

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
