// isoline best DIR... --out FILE: the best losses of runs, where no least loss is declared.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/best.h"
#include "benchmarks/plan/catalog.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

std::vector<Record> records_under(const std::vector<std::string>& folders) {
  std::vector<Record> records;
  for (const fs::path folder : folders) {
    require(fs::exists(folder / "runs"),
            [&] { return fmt::format("{}: no such result folder", folder.string()); });
    for (const auto& entry : fs::directory_iterator(folder / "runs"))
      if (entry.path().extension() == ".json") records.push_back(read_record(entry.path()));
  }
  return records;
}

// Rows stand each on a line, so that a change of the table is read in its difference.
std::string text_of(const Json& table) {
  std::string rows;
  for (const Json& row : table.at("rows")) rows += (rows.empty() ? "" : ",\n") + json_text(row);
  return fmt::format("{{\"schema\": {}, \"rows\": [\n{}\n]}}\n", json_text(table.at("schema")),
                     rows);
}

}  // namespace

int best_verb(const BestArguments& given, Session& session) {
  BestLosses best;
  if (fs::exists(given.out)) best = BestLosses::from_json(read_json(given.out), given.out);
  std::map<std::string, bool> declares;  // by problem, whether it knows its least loss
  std::size_t improved = 0;
  for (const Record& record : records_under(given.folders)) {
    const Component& problem = record.request.problem;
    if (!session.catalog().problems.contains(problem.name)) continue;
    const auto [known, is_new] = declares.try_emplace(problem.spec, false);
    if (is_new) known->second = declares_minimum(session.catalog(), problem, record.request.seed);
    if (!known->second) improved += best.add(record);
  }
  write_text(given.out, text_of(best.to_json()));
  say(stdout, fmt::format("{}: best losses new or improved: {}\n", given.out, improved));
  return kGood;
}

}  // namespace isoline::benchmarks
