// isoline status DIR: how far a run is, in shards or not, while it goes on.
#include <fmt/format.h>

#include <ctime>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/shard/census.h"
#include "core/clock.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;
namespace {

std::string or_null(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : "null";
}

std::string json_of(const Census& census, std::int64_t now) {
  std::string end = "null";
  if (census.remaining_seconds)
    end = "\"" + instant_text(now + static_cast<std::int64_t>(*census.remaining_seconds)) + "\"";
  return fmt::format(
      "{{\"planned\": {}, \"done\": {}, \"running\": {}, \"failed\": {}, \"left\": {}, "
      "\"left_seconds\": {}, \"remaining_seconds\": {}, \"end\": {}}}\n",
      census.planned, census.done, census.running, census.failed, census.left,
      or_null(census.left_seconds), or_null(census.remaining_seconds), end);
}

std::string words_of(const Census& census, std::int64_t now) {
  std::string text = fmt::format("{}: {} done, {} of them failed, {} running, {} left\n",
                                 counted(census.planned, "cell"), census.done, census.failed,
                                 census.running, census.left);
  if (census.done == census.planned) return text;
  if (census.left_seconds)
    text += fmt::format("predicted of what is not done: {}, one at a time\n",
                        duration_text(*census.left_seconds));
  if (!census.remaining_seconds)
    return text + "no cell ended in the last hour: there is no pace to predict an end by\n";
  return text +
         fmt::format("at the pace of the last hour the end is in {}, at {}\n",
                     duration_text(*census.remaining_seconds),
                     instant_text(now + static_cast<std::int64_t>(*census.remaining_seconds)));
}

}  // namespace

int status_verb(const StatusArguments& given, Session&) {
  const std::int64_t now = std::time(nullptr);
  const Census census = census_of(given.folder, now, on_terminal("records"));
  say(stdout, given.as_json ? json_of(census, now) : words_of(census, now));
  return census.failed > 0 ? kWorse : kGood;
}

}  // namespace isoline::benchmarks
