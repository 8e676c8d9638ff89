// Writes invented records where a report looks for them, with their plan and their sheets.
#include <algorithm>
#include <atomic>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/records/request.h"
#include "core/records/sheet.h"
#include "tests/reports/synthetic.h"

namespace isoline::reports {

namespace {

namespace fs = std::filesystem;

void save(const fs::path& file, const Json& json) { std::ofstream(file) << json.dump() << '\n'; }

Sheet sheet_of(const std::string& kind, const Component& of) {
  const bool is_problem = kind == "problem";
  return {.kind = kind,
          .name = of.name,
          .spec = of.spec,
          .title = is_problem ? "An invented inverse problem" : "An invented method",
          .formula = is_problem ? "L = ½‖P(x) − y*‖²" : "θ ← θ + Δθ",
          .source = "none: its runs are drawn",
          .options_text = "[]",
          .family = is_problem ? "" : "first-order",
          .inverse = is_problem ? "none" : "",
          .unknowns = is_problem ? 16 : 0,
          .residuals = is_problem ? 16 : 0};
}

void write_sheets(const fs::path& folder, const SyntheticSize& size) {
  const auto write = [&](const Sheet& sheet) {
    save(folder / "components" / sheet.file_name(), to_json(sheet));
  };
  for (std::size_t p = 0; p < size.problems; ++p)
    write(sheet_of("problem",
                   synthetic_record(size, p * size.optimizers * size.seeds).request.problem));
  for (std::size_t s = 0; s < size.optimizers; ++s)
    write(sheet_of("optimizer", synthetic_record(size, s * size.seeds).request.optimizer));
}

}  // namespace

void write_synthetic_study(const fs::path& folder, const SyntheticSize& size) {
  for (const char* part : {"runs", "components"}) fs::create_directories(folder / part);
  write_sheets(folder, size);
  Plan plan{.suites = {"synthetic"}, .cells = std::vector<PlannedCell>(size.records())};
  std::atomic<std::size_t> next{0};
  const auto write_some = [&] {
    for (std::size_t i = next++; i < plan.cells.size(); i = next++) {
      const Record record = synthetic_record(size, i);
      const Request& request = record.request;
      plan.cells[i] = {record.cell, request.problem.spec, request.optimizer.spec, request.seed};
      save(folder / "runs" / record.file_name(), to_json(record));
    }
  };
  {
    const std::jthread other(write_some);
    write_some();
  }
  save(folder / "plan.json", to_json(plan));
}

}  // namespace isoline::reports
