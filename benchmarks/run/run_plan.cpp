// The used rows of rates, joined to those of the folder.
#include "benchmarks/run/run_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "benchmarks/run/certificate.h"
#include "benchmarks/run/interrupts.h"
#include "benchmarks/run/sheets.h"
#include "benchmarks/run/store.h"
#include "core/clock.h"
#include "core/files.h"
#include "core/json.h"
#include "core/options.h"

namespace isoline::benchmarks {
namespace {

using RowsByPair = std::map<std::pair<std::string, std::string>, Json>;

// The cells of an earlier plan; a damaged file is moved away, and written again.
RowsByPair stored_rows(const std::filesystem::path& file, Store& store) {
  RowsByPair rows;
  if (!is_there(file)) return rows;
  try {
    const Json table = read_json(file);
    for (const Json& row : table.at("rows")) rows[{row.at("problem"), row.at("optimizer")}] = row;
  } catch (const std::exception& error) {
    rows.clear();
    store.set_aside(file, error.what());
  }
  return rows;
}

// "direct" of "direct.json": what a search in that table alone calls it.
std::string table_of(const std::string& origin) { return origin.substr(0, origin.rfind(".json")); }

}  // namespace

void write_used_rates(const Rates& rates, const std::vector<Request>& requests, Store& store) {
  const std::filesystem::path file = store.folder() / "rates.json";
  RowsByPair rows = stored_rows(file, store);
  for (const Request& request : requests) {
    if (request.rates.empty()) continue;
    const auto& [problem, optimizer] = std::pair(request.problem, request.optimizer.name);
    const Rates::Row* row = rates.find(problem, optimizer, table_of(request.rates));
    if (!row) continue;
    rows[{problem.spec, optimizer}] = {{"problem", problem.spec},
                                       {"optimizer", optimizer},
                                       {"options", to_json(row->options)},
                                       {"file", row->origin},
                                       {"source", parse_json(row->source, row->origin)}};
  }
  if (rows.empty()) return;
  Json all = Json::array();
  for (const auto& [pair, row] : rows) all.push_back(row);
  write_text(file, json_text(Json{{"schema", "isoline.rates/1"}, {"rows", all}}) + "\n");
}

// A plan stored, sheeted and run; and what its folder is called.

namespace {

// The distinct names in order, "-a-b"; or how many there are, "-17-problems".
std::string names_of(const std::vector<Request>& requests, Component Request::*component,
                     const char* many) {
  constexpr std::size_t kMostNamed = 3;
  std::vector<std::string> names;
  for (const Request& request : requests)
    if (const std::string& name = (request.*component).name;
        std::ranges::find(names, name) == names.end())
      names.push_back(name);
  if (names.size() > kMostNamed) return fmt::format("-{}-{}", names.size(), many);
  std::string text;
  for (const std::string& name : names) text += "-" + name;
  return text;
}

}  // namespace

std::vector<PlannedCell> planned_cells(const std::vector<Request>& requests) {
  std::vector<PlannedCell> cells;
  for (const Request& request : requests)
    cells.push_back({request.cell, request.problem.spec, request.optimizer.spec, request.seed});
  return cells;
}

Outcome run_plan(const Catalog& catalog, const WholePlan& whole,
                 const std::vector<Request>& requests, const std::filesystem::path& folder,
                 const RunOptions& options) {
  const std::int64_t begun = monotonic_nanoseconds();
  const InterruptGuard guard;
  Outcome outcome{.planned = static_cast<std::int64_t>(requests.size()), .is_interrupted = true};
  require_sound(catalog, requests);
  Store store(folder);
  require_certified(catalog, requests, store, options.progress);
  if (asked_to_end() != Asked::nothing) return outcome;
  store.plan(whole.name, whole.cells);
  write_used_rates(whole.rates, requests, store);
  write_sheets(catalog, requests, store, options.progress);
  if (asked_to_end() != Asked::nothing) return outcome;
  outcome = run_all(catalog, requests, store, options);
  if (!outcome.missing.empty()) {
    store.make_folders();
    store.plan(whole.name, whole.cells);
  }
  outcome.remarks = store.remarks();
  outcome.seconds = 1e-9 * static_cast<double>(monotonic_nanoseconds() - begun);
  return outcome;
}

Outcome run_plan(const Catalog& catalog, const std::string& name,
                 const std::vector<Request>& requests, const std::filesystem::path& folder,
                 const RunOptions& options, const Rates& rates) {
  return run_plan(catalog, {name, planned_cells(requests), rates}, requests, folder, options);
}

std::string folder_name_of(const std::vector<Request>& requests, const std::string& title) {
  constexpr std::size_t kDigits = 8;
  std::vector<std::string> cells;
  for (const Request& request : requests) cells.push_back(request.cell);
  std::ranges::sort(cells);  // the order of the words on the command line does not matter
  std::string all;
  for (const std::string& cell : cells) all += cell;
  const std::string names = title + names_of(requests, &Request::problem, "problems") +
                            names_of(requests, &Request::optimizer, "optimizers");
  return fmt::format("{}-{}", names.substr(names.starts_with('-') ? 1 : 0),
                     digest(all).substr(0, kDigits));
}

}  // namespace isoline::benchmarks
