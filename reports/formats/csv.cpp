// The report as tidy CSV: one row a run, and one for each planned cell that has not run; and one
// row a figure of the statistics.
#include <fmt/format.h>

#include "reports/formats/escape.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

void add(std::string& row, std::string_view field) {
  if (!row.empty() && row.back() != '\n') row += ',';
  row += field;
}

std::string header(const Comparison& c) {
  std::string row =
      "problem,optimizer,seed,status,iterations,work,start_loss,loss,best_loss,x_error";
  for (const Tolerance& tolerance : c.yardstick.tolerances)
    row += fmt::format(",work_to_{}", tolerance.name);
  for (const Tolerance& tolerance : c.yardstick.tolerances)
    row += fmt::format(",cost_to_{}", tolerance.name);
  for (const Tolerance& tolerance : c.yardstick.tolerances)
    row += fmt::format(",seconds_to_{}", tolerance.name);
  row += ",cost";
  for (const std::string_view oracle : kOracleNames) row += fmt::format(",{}", oracle);
  return row +
         ",wall_seconds,timed_alone,peak_memory_bytes,privileges,message,claimed,cell,build,"
         "command\n";
}

std::string row_of(const Run& run) {
  const Record& record = *run.record;
  const Request& request = record.request;
  const Summary& summary = record.summary;
  std::string row = csv_field(request.problem.spec);
  add(row, csv_field(request.optimizer.spec));
  add(row, std::to_string(request.seed));
  add(row, name_of(record.status));
  add(row, std::to_string(summary.iterations));
  add(row, std::to_string(summary.work));
  for (const Real value : {summary.start_loss, summary.loss, summary.best_loss, summary.x_error})
    add(row, exact_figure(value));
  for (const Real work : run.taken[Measure::work]) add(row, exact_figure(work));
  for (const Real cost : run.taken[Measure::cost]) add(row, exact_figure(cost));
  for (const Real seconds : run.taken[Measure::time]) add(row, exact_figure(seconds));
  add(row, exact_figure(run.spent));
  for (const std::int64_t count : record.counts) add(row, std::to_string(count));
  add(row, exact_figure(summary.wall_seconds));
  add(row, run.is_timed_alone ? "true" : "false");
  add(row, std::to_string(summary.peak_memory_bytes));
  add(row, csv_field(joined(record.privileges, "; ")));
  for (const std::string& text :
       {record.message, record.claimed, record.cell, record.build, rerun_command(request)})
    add(row, csv_field(text));
  return row + '\n';
}

// As many fields as any other row; all figures empty.
std::string row_of(const PlannedCell& cell) {
  const std::string before_cell(23 + kOracles, ',');
  return fmt::format("{},{},{},missing{}{},,\n", csv_field(cell.problem), csv_field(cell.optimizer),
                     cell.seed, before_cell, csv_field(cell.cell));
}

}  // namespace

std::string csv_report(const Document& document) {
  std::string text = header(document.comparison);
  for (const Run& run : document.comparison.runs) text += row_of(run);
  for (const PlannedCell& cell : document.comparison.missing) text += row_of(cell);
  return text;
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
