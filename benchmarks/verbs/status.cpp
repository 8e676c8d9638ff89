// isoline status DIR: how far a run is, in shards or not, while it goes on.
#include <fmt/format.h>

#include <ctime>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/shard/census.h"
#include "core/clock.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

struct StatusArguments {
  std::string folder;
  bool as_json = false;
};

void declare(VerbArguments& verb, StatusArguments& given) {
  verb.text("DIR", given.folder, "Result folder of a run, with or without shards").required();
  verb.flag("--json", given.as_json, "Print JSON");
}

std::string or_null(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : "null";
}

std::string census_json(const Census& census, std::int64_t now) {
  std::string end = "null";
  if (census.remaining_seconds)
    end = "\"" + instant_text(now + static_cast<std::int64_t>(*census.remaining_seconds)) + "\"";
  return fmt::format(
      "{{\"planned\": {}, \"done\": {}, \"running\": {}, \"failed\": {}, \"left\": {}, "
      "\"left_seconds\": {}, \"remaining_seconds\": {}, \"end\": {}}}\n",
      census.planned, census.done, census.running, census.failed, census.left,
      or_null(census.left_seconds), or_null(census.remaining_seconds), end);
}

std::string census_text(const Census& census, std::int64_t now) {
  std::string text = fmt::format("{}: {} done, {} of them failed, {} running, {} left\n",
                                 reports::counted(census.planned, "cell"), census.done,
                                 census.failed, census.running, census.left);
  if (census.done == census.planned) return text;
  if (census.left_seconds)
    text += fmt::format("predicted time of the rest: {}, one cell at a time\n",
                        duration_text(*census.left_seconds));
  if (!census.remaining_seconds)
    return text + "no cell ended in the last hour, so the end cannot be predicted\n";
  return text +
         fmt::format("at the pace of the last hour, the run ends in {}, at {}\n",
                     duration_text(*census.remaining_seconds),
                     instant_text(now + static_cast<std::int64_t>(*census.remaining_seconds)));
}

int run(const StatusArguments& given, Session&) {
  const std::int64_t now = std::time(nullptr);
  const Census census = census_of(given.folder, now, progress_on_terminal("records"));
  say(stdout, given.as_json ? census_json(census, now) : census_text(census, now));
  return census.failed > 0 ? kWorse : kGood;
}

}  // namespace

void register_status(VerbRegistry& registry) {
  registry.add(
      verb_of({.name = "status",
               .help_position = 90,
               .summary = "Show the progress of a run",
               .examples = "  isoline status results/quick\n  isoline status results/quick --json",
               .notes = "Reads the records, the plan and the predictions, and starts nothing.\n"
                        "Exit codes: 0 good so far, 2 cells failed."},
              declare, run));
}

}  // namespace isoline::benchmarks
