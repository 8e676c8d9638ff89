// Writes all formats of a report into a folder.
#include "reports/report.h"

#include "core/json.h"
#include "reports/tables_formats.h"

namespace isoline {

void write_report(const Comparison& comparison, const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  write_text(out / "index.html", html_report(comparison));
  write_text(out / "report.md", markdown_report(comparison));
  write_text(out / "report.tex", latex_report(comparison));
  write_text(out / "report.csv", csv_report(comparison));
  write_text(out / "statistics.csv", statistics_csv(comparison));
  write_text(out / "report.json", json_report(comparison));
}

}  // namespace isoline
