// The report as tidy CSV: one row a run, and one for each planned cell that has not run; and one
// row a figure of the statistics.
#include <fmt/format.h>

#include <functional>

#include "core/oracle.h"
#include "reports/formats/escape.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

struct CsvColumn {
  std::string name;
  std::function<std::string(const Run&)> text;
};

void add_reached(std::vector<CsvColumn>& columns, const Yardstick& yardstick, const char* what,
                 Measure by) {
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    columns.push_back({fmt::format("{}_to_{}", what, yardstick.tolerances[t].name),
                       [by, target = yardstick.tolerances[t].rung](const Run& run) {
                         return exact_figure(run.taken(by, target));
                       }});
}

using CsvColumns = std::vector<CsvColumn>;

void add(CsvColumns& columns, const char* name, Real Summary::*value) {
  columns.push_back(
      {name, [value](const Run& run) { return exact_figure(run.record->summary.*value); }});
}
void add(CsvColumns& columns, const char* name, std::int64_t Summary::*value) {
  columns.push_back(
      {name, [value](const Run& run) { return std::to_string(run.record->summary.*value); }});
}
void add(CsvColumns& columns, const char* name, std::string (*text)(const Record&)) {
  columns.push_back({name, [text](const Run& run) { return csv_field(text(*run.record)); }});
}

std::string count_of(const Run& run, std::size_t kind) {
  return std::to_string(run.record->counts[kind]);
}
std::string is_timed_alone(const Run& run) { return run.is_timed_alone ? "true" : "false"; }

void add_figures(CsvColumns& columns, const Yardstick& yardstick) {
  add(columns, "iterations", &Summary::iterations);
  add(columns, "work", &Summary::work);
  add(columns, "start_loss", &Summary::start_loss);
  add(columns, "loss", &Summary::loss);
  add(columns, "best_loss", &Summary::best_loss);
  add(columns, "x_error", &Summary::x_error);
  add_reached(columns, yardstick, "work", Measure::work);
  add_reached(columns, yardstick, "cost", Measure::cost);
  add_reached(columns, yardstick, "seconds", Measure::time);
  add_reached(columns, yardstick, "iterations", Measure::iterations);
  columns.push_back({"cost", [](const Run& run) { return exact_figure(run.spent); }});
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    columns.push_back(
        {std::string(kOracleNames[kind]), [kind](const Run& run) { return count_of(run, kind); }});
  add(columns, "wall_seconds", &Summary::wall_seconds);
  columns.push_back({"timed_alone", is_timed_alone});
  add(columns, "peak_memory_bytes", &Summary::peak_memory_bytes);
}

CsvColumns columns_of_runs(const Yardstick& yardstick) {
  CsvColumns columns;
  add(columns, "problem", [](const Record& record) { return record.request.problem.spec; });
  add(columns, "optimizer", [](const Record& record) { return record.request.optimizer.spec; });
  add(columns, "seed", [](const Record& record) { return std::to_string(record.request.seed); });
  add(columns, "status", [](const Record& record) { return std::string(name_of(record.status)); });
  add_figures(columns, yardstick);
  add(columns, "privileges", [](const Record& record) { return joined(record.privileges, "; "); });
  add(columns, "message", [](const Record& record) { return record.message; });
  add(columns, "claimed", [](const Record& record) { return record.claimed; });
  add(columns, "cell", [](const Record& record) { return record.cell; });
  add(columns, "build", [](const Record& record) { return record.build; });
  add(columns, "command", [](const Record& record) { return rerun_command(record.request); });
  return columns;
}

// A planned cell that has not run: all values are empty.
std::string planned_text(const PlannedCell& cell, const std::string& column) {
  if (column == "problem") return csv_field(cell.problem);
  if (column == "optimizer") return csv_field(cell.optimizer);
  if (column == "seed") return std::to_string(cell.seed);
  if (column == "status") return "missing";
  return column == "cell" ? csv_field(cell.cell) : "";
}

template <class Text>
void add_line(std::string& csv, const std::vector<CsvColumn>& columns, Text text) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i > 0) csv += ',';
    csv += text(columns[i]);
  }
  csv += '\n';
}

}  // namespace

std::string csv_report(const Document& document) {
  const Comparison& c = document.comparison;
  const std::vector<CsvColumn> columns = columns_of_runs(c.yardstick);
  std::string csv;
  add_line(csv, columns, [](const CsvColumn& column) { return column.name; });
  for (const Run& run : c.runs)
    if (!run.is_repeated)
      add_line(csv, columns, [&](const CsvColumn& column) { return column.text(run); });
  for (const PlannedCell& cell : c.missing)
    add_line(csv, columns,
             [&](const CsvColumn& column) { return planned_text(cell, column.name); });
  return csv;
}

std::string statistics_csv(const Document& document) {
  std::string text = "table,row,column,value\n";
  for (const Table& table : document.section("statistics").tables)
    for (const auto& row : table.rows)
      for (std::size_t i = 1; i < row.size(); ++i)
        text += fmt::format("{},{},{},{}\n", table.id, csv_field(row[0].text),
                            csv_field(table.columns[i]), csv_field(row[i].text));
  return text;
}

}  // namespace isoline::reports
