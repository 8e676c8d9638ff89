// The curves of a study as tidy CSV.
#include <fmt/format.h>

#include "core/oracle.h"
#include "reports/exports/exports.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// RFC 4180: quoted where a comma, a quote or a line end stands in it, quotes doubled. To the byte,
// unlike the report's own table, which a spreadsheet opens: this one is for programs.
std::string field_of(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + '"';
}

std::string optional_figure(const std::optional<Real>& value) {
  return value ? exact_figure(*value) : "";
}

// "true", "false", or nothing where it is not known.
std::string verified_text(const Record& record, const std::string& tau) {
  const auto at = record.verified.find(tau);
  if (at == record.verified.end() || !at->second) return "";
  return *at->second ? "true" : "false";
}

std::string head() {
  std::string names =
      "problem,optimizer,seed,status,cell,build,imported,verified_1e-1,verified_1e-3,verified_1e-6,"
      "minimum,scale,x_scale,iteration,work";
  for (const std::string_view oracle : kOracleNames) names += fmt::format(",{}", oracle);
  return names + ",wall_seconds,processor_seconds,loss,x_error,gradient_norm,step_norm\r\n";
}

// What all rows of a run begin with.
std::string who_of(const Record& record) {
  const Request& request = record.request;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", field_of(request.problem.spec),
                     field_of(request.optimizer.spec), request.seed, name_of(record.status),
                     record.cell, record.build, record.imported ? "true" : "false",
                     verified_text(record, "1e-1"), verified_text(record, "1e-3"),
                     verified_text(record, "1e-6"), optional_figure(record.minimum),
                     optional_figure(record.scale), optional_figure(record.x_scale));
}

void add_rows(std::string& csv, const Record& record) {
  const Curve& curve = record.curve;
  const std::string who = who_of(record);
  for (std::size_t i = 0; i < curve.iteration.size(); ++i) {
    csv += fmt::format("{},{},{}", who, curve.iteration[i], curve.work[i]);
    for (const std::string_view oracle : kOracleNames) {
      const auto counts = curve.counts.find(std::string(oracle));
      csv += fmt::format(",{}", counts == curve.counts.end() ? 0 : counts->second[i]);
    }
    for (const auto* column : {&curve.wall_seconds, &curve.processor_seconds, &curve.loss,
                               &curve.x_error, &curve.gradient_norm, &curve.step_norm})
      csv += "," + exact_figure((*column)[i]);
    csv += "\r\n";
  }
  constexpr std::size_t kFigures = 8;  // of each point, its counts by oracle aside
  if (curve.iteration.empty()) csv += who + std::string(kFigures + kOracles, ',') + "\r\n";
}

}  // namespace

std::string curves_csv(const Comparison& comparison) {
  std::string csv = head();
  for (const Run& run : comparison.runs)
    if (!run.is_repeated) add_rows(csv, *run.record);
  return csv;
}

}  // namespace isoline::reports
