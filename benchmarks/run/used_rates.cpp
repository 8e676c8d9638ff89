// The used rows of rates, joined to those of the folder.
#include "benchmarks/run/used_rates.h"

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/options.h"

namespace isoline::benchmarks {
namespace {

using RowsByPair = std::map<std::pair<std::string, std::string>, Json>;

// What an earlier plan has left; a damaged file is set aside, and written anew.
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

}  // namespace isoline::benchmarks
