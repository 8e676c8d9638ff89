// Writes all formats of a report into a folder, several at a time.
#include "reports/report.h"

#include "core/files.h"
#include "core/json.h"
#include "core/threads.h"
#include "reports/tables/formats.h"

namespace isoline::reports {

void write_report(const Comparison& comparison, const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  const std::vector<std::pair<const char*, std::string (*)(const Comparison&)>> formats = {
      {"index.html", html_report},  {"report.csv", csv_report},
      {"report.json", json_report}, {"report.md", markdown_report},
      {"report.tex", latex_report}, {"statistics.csv", statistics_csv}};
  share(formats.size(),
        [&](std::size_t i) { write_text(out / formats[i].first, formats[i].second(comparison)); });
}

}  // namespace isoline::reports
