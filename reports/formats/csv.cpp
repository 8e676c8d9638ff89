// The report as tidy CSV: one row per run or missing cell, and one row per number of the
// statistics.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <string_view>
#include <utility>

#include "core/oracle.h"
#include "core/seeds.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

struct CsvColumn {
  std::string name;
  std::function<std::string(const Run&)> text;
};
using CsvColumns = std::vector<CsvColumn>;

CsvColumns columns_of_runs(const Yardstick& yardstick) {
  CsvColumns columns;
  const auto add = [&](const std::string& name, auto text) {
    columns.push_back({name, [text](const Run& run) { return csv_field(text(*run.record)); }});
  };
  const auto add_figure = [&](const std::string& name, auto value) {
    columns.push_back(
        {name, [value](const Run& run) { return exact_figure(static_cast<Real>(value(run))); }});
  };
  const auto add_summary = [&](const char* name, auto member) {
    add_figure(name, [member](const Run& run) { return run.record->summary.*member; });
  };
  add("problem", [](const Record& record) { return record.request.problem.spec; });
  add("optimizer", [](const Record& record) { return record.request.optimizer.spec; });
  add("method", [](const Record& record) { return record.request.optimizer.name; });
  add("seed", [](const Record& record) { return std::to_string(record.request.seed); });
  add("instance",
      [](const Record& record) { return std::to_string(instance_of(record.request.seed)); });
  add("start", [](const Record& record) { return std::to_string(start_of(record.request.seed)); });
  add("status", [](const Record& record) { return name_of(record.status); });
  add_summary("iterations", &Summary::iterations);
  add_summary("work", &Summary::work);
  add_summary("start_loss", &Summary::start_loss);
  add_summary("loss", &Summary::loss);
  add_summary("best_loss", &Summary::best_loss);
  add_summary("x_error", &Summary::x_error);
  for (const auto& [what, by] : {std::pair("work", Measure::work),
                                 {"cost", Measure::cost},
                                 {"seconds", Measure::time},
                                 {"iterations", Measure::iterations}})
    for (const Tolerance& tolerance : yardstick.tolerances)
      add_figure(fmt::format("{}_to_{}", what, tolerance.name),
                 [by, target = tolerance.rung](const Run& run) { return run.taken(by, target); });
  add_figure("cost", [](const Run& run) { return run.spent; });
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    add_figure(std::string(kOracleNames[kind]),
               [kind](const Run& run) { return run.record->counts[kind]; });
  add_summary("wall_seconds", &Summary::wall_seconds);
  columns.push_back(
      {"timed_alone", [](const Run& run) { return run.is_timed_alone ? "true" : "false"; }});
  add_summary("peak_memory_bytes", &Summary::peak_memory_bytes);
  add("privileges", [](const Record& record) { return joined(record.privileges, "; "); });
  add("message", [](const Record& record) { return record.message; });
  add("claimed", [](const Record& record) { return record.claimed; });
  add("cell", [](const Record& record) { return record.cell; });
  add("build", [](const Record& record) { return record.build; });
  add("command", [](const Record& record) { return rerun_command(record.request); });
  return columns;
}

// A planned cell that has not run: all values are empty.
std::string planned_text(const PlannedCell& cell, const std::string& column) {
  if (column == "problem") return csv_field(cell.problem);
  if (column == "optimizer") return csv_field(cell.optimizer);
  if (column == "method") return csv_field(cell.optimizer.substr(0, cell.optimizer.find('[')));
  if (column == "seed") return std::to_string(cell.seed);
  if (column == "instance") return std::to_string(instance_of(cell.seed));
  if (column == "start") return std::to_string(start_of(cell.seed));
  if (column == "status") return "missing";
  return column == "cell" ? csv_field(cell.cell) : "";
}

template <class Text>
void add_line(std::string& csv, const CsvColumns& columns, Text text) {
  for (const CsvColumn& column : columns)
    csv += (&column == columns.data() ? "" : ",") + text(column);
  csv += '\n';
}

}  // namespace

std::string csv_report(const Document& document) {
  const Comparison& c = document.comparison;
  const CsvColumns columns = columns_of_runs(c.yardstick);
  constexpr std::size_t kRow = 512;  // bytes, about: a text that grows is there twice
  std::string csv;
  csv.reserve(kRow * c.runs.size());
  add_line(csv, columns, [](const CsvColumn& column) { return column.name; });
  for (const Run& run : c.runs)
    if (!run.is_repeated)
      add_line(csv, columns, [&](const CsvColumn& column) { return column.text(run); });
  for (const PlannedCell& cell : c.missing)
    add_line(csv, columns,
             [&](const CsvColumn& column) { return planned_text(cell, column.name); });
  return csv;
}

namespace {

struct CellNumbers {
  Real value = std::numeric_limits<Real>::quiet_NaN(), low = value, high = value, n = value;
  std::string_view unit = "";
};

// "38 [19–73] (3/3)", "3 : 6.33 [6.2–6.5]" of a declared and a measured cost, "44 %", "13/16",
// "0.1–0.9"; nothing of any other text. Of counts "3/5" alone the value is 3 of n = 5.
CellNumbers numbers_of(std::string_view text) {
  CellNumbers all;
  const auto skip = [&](std::string_view mark) {
    const bool is_there = text.starts_with(mark);
    if (is_there) text.remove_prefix(mark.size());
    return is_there;
  };
  const auto number = [&] {
    Real value = std::numeric_limits<Real>::quiet_NaN();
    if (skip("✗")) return kNever;
    if (const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        error == std::errc{})
      text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
  };
  all.value = number();
  if (skip(" : ")) {
    all.unit = "forward solves";
    all.value = number();
  }
  if (std::isnan(all.value)) return {};
  if (skip(" %")) all.unit = "%";
  if (skip("/")) all.n = number();
  if (skip("–")) {
    all.low = std::exchange(all.value, all.n);
    all.high = number();
  }
  if (skip(" [")) {
    all.low = number();
    if (skip("–")) all.high = number();
    skip("]");
  }
  if (skip(" (") && !std::isnan(number()) && skip("/")) {
    all.n = number();
    skip(")");
  }
  return text.empty() ? all : CellNumbers{};
}

std::string number_field(Real value) { return std::isnan(value) ? "" : exact_figure(value); }

}  // namespace

// The numbers of each cell, and its text as every format has it.
std::string statistics_csv(const Document& document) {
  std::string text = "table,row,column,value,low,high,n,unit,text\n";
  for (const char* section : {"statistics", "conduct"})
    for (const Table& table : document.section(section).tables)
      for (const auto& row : table.rows)
        for (std::size_t i = 1; i < row.size(); ++i) {
          const CellNumbers all = numbers_of(row[i].text);
          text += fmt::format("{},{},{},{},{},{},{},{},{}\n", table.id, csv_field(row[0].text),
                              csv_field(table.columns[i]), number_field(all.value),
                              number_field(all.low), number_field(all.high), number_field(all.n),
                              all.unit, csv_field(row[i].text));
        }
  return text;
}

}  // namespace isoline::reports
