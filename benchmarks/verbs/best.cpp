// isoline best DIR... --out FILE: writes the lowest losses for problems that do not declare a least
// loss.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/rates.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/output.h"
#include "core/seeds.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct BestArguments {
  std::vector<std::string> folders;
  std::string out = "benchmarks/best.json";
};

void declare(VerbArguments& verb, BestArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--out", given.out,
            "Table of best losses to write or to extend; the lower of two losses is kept")
      .shown();
}

std::vector<Record> records_under(const std::vector<std::string>& folders) {
  std::vector<Record> records;
  for (const fs::path folder : folders) {
    require(fs::exists(folder / "runs"), [&] {
      return folder.string() + " is not a result folder; `isoline run --out FOLDER` creates one";
    });
    for (const auto& entry : fs::directory_iterator(folder / "runs"))
      if (entry.path().extension() == ".json") records.push_back(read_record(entry.path()));
  }
  require(!records.empty(), "no records in these folders; `isoline run --out FOLDER` creates some");
  return records;
}

// One row per line, so that a diff of the table is readable.
std::string best_losses_text(const Json& table) {
  std::string rows;
  for (const Json& row : table.at("rows")) rows += (rows.empty() ? "" : ",\n") + json_text(row);
  return fmt::format("{{\"schema\": {}, \"rows\": [\n{}\n]}}\n", json_text(table.at("schema")),
                     rows);
}

int run(const BestArguments& given, Session& session) {
  make_output_folder(fs::path(given.out).parent_path());
  BestLosses best;
  if (fs::exists(given.out)) best = BestLosses::from_json(read_json(given.out), given.out);
  std::map<std::string, bool> declares;  // by problem, whether it knows its least loss
  std::set<std::pair<std::string, std::uint64_t>> improved;  // problems and instances
  for (const Record& record : records_under(given.folders)) {
    const Component& problem = record.request.problem;
    if (!session.catalog().problems.contains(problem.name)) continue;
    const auto [known, is_new] = declares.try_emplace(problem.spec, false);
    if (is_new) known->second = record.minimum && !record.is_best_known;  // nothing is started
    if (!known->second && best.add(record))
      improved.emplace(problem.spec, instance_of(record.request.seed));
  }
  write_text(given.out, best_losses_text(best.to_json()));
  say(stdout, fmt::format("{}: best losses new or improved: {}\n", given.out, improved.size()));
  return kGood;
}

}  // namespace

void register_best(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "best",
       .help_position = 100,
       .summary =
           "Write the lowest losses found, for problems that do not declare a least attainable "
           "loss",
       .examples = "  isoline best results/quick --out benchmarks/best.json",
       .notes = "If a problem does not declare its least attainable loss, tolerances refer to the "
                "lowest known loss. The table benchmarks/best.json is compiled into the program; "
                "`isoline run --best FILE` reads another one."},
      declare, run));
}

}  // namespace isoline::benchmarks
