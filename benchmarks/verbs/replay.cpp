// isoline replay RECORD...: runs the cells of records again, and compares the results bit for bit.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <random>

#include "benchmarks/cli/verb.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/store.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct ReplayArguments {
  std::vector<std::string> records;
  std::string sample;             // "1%", "20"; empty: all of the records
  std::string out;                // a result folder for the new records; empty: none
  std::uint64_t seed = 0;         // of the sample; 0: another one each time
  std::int64_t memory_bytes = 0;  // 0: as the runner has it
  bool trust = false;
};

void declare(VerbArguments& verb, ReplayArguments& given) {
  verb.texts("RECORD", given.records,
             "Records of `isoline run`, which are files in runs/; with --sample, result folders")
      .required();
  verb.text("--sample", given.sample, "Replay a random sample of the records, such as 1% or 20");
  verb.seed("--seed", given.seed, "Seed of the sample; 0: a new seed each time, which is printed");
  verb.text("--out", given.out, "Result folder in which the new records are kept");
  verb.memory("--memory", given.memory_bytes, "Memory limit of a cell (default: 4GB)");
  verb.flag("--trust", given.trust, kTrust);
  verb.plugins();
}

// Why the two were not made by the same program on the same platform; empty where they were.
std::string difference_of_builds(const Record& record, const Request& request) {
  if (record.cell != request.cell)
    return "with the options of this program, the request identifies another cell";
  if (record.build == build_digest(request)) return "";
  std::string parts;
  for (const auto& [part, digest] : build_parts(request)) {
    const auto stored = record.build_parts.find(part);
    if (stored != record.build_parts.end() && stored->second == digest) continue;
    parts += (parts.empty() ? "" : ", ") + part;
  }
  return "another build computed it; these parts differ: " + parts;
}

std::string comparison_text(const Comparison& found) {
  if (!found.difference.empty()) return "differs: " + found.difference;
  if (found.is_up_to_there)
    return fmt::format("equal up to iteration {}, where a time limit or a signal ended one of them",
                       found.iterations);
  return fmt::format("equal, {} iteration{}", found.iterations, found.iterations == 1 ? "" : "s");
}

// The exit code of one record.
int replay(const std::string& path, const ReplayArguments& given, Session& session) {
  require(!fs::is_directory(path), [&] {
    return fmt::format(
        "{0} is a folder: pass the files of records, such as {0}/runs/*.json, or --sample 20",
        path);
  });
  const Record record = [&] {
    try {
      return read_unchecked_record(path);
    } catch (const UsageError& error) {
      const std::string why = error.what();
      throw UsageError(why.find(path) == why.npos ? path + ": " + why : why);
    }
  }();
  require_trust(given.trust, record);
  const std::string title = fmt::format("{}: {}", path, title_of(record.request));
  Request request;
  try {
    constexpr double kLeast = 60, kSlower = 10;  // the machine may be slower, and busy
    request = request_again(session.catalog(), record,
                            std::max(kLeast, kSlower * record.summary.wall_seconds));
  } catch (const UsageError& error) {
    say(stdout, fmt::format("{}: not comparable: {}\n", title, error.what()));
    return kNotComparable;
  }
  const std::string builds = difference_of_builds(record, request);
  RunOptions options{.force = true,
                     .keeps_fields = record.fields.has_value(),
                     .keeps_spectra = record.spectrum.has_value(),
                     .command = session.command()};
  if (given.memory_bytes > 0) options.limits.memory_bytes = given.memory_bytes;
  const HiddenFolder folder;
  Store store(given.out.empty() ? folder.path() : fs::path(given.out));
  if (run_all(session.catalog(), {request}, store, options).is_interrupted) return kInterrupted;
  std::optional<Record> again = store.find(request);
  if (!again) {
    say(stdout, fmt::format("{}: not comparable: another program killed its process\n", title));
    return kNotComparable;
  }
  again->cell = record.cell;  // compared above
  again->request = record.request;
  const Comparison found = compare_results(record, *again);
  say(stdout,
      fmt::format("{}: {}{}\n", title, builds.empty() ? "" : "not comparable: " + builds + "; ",
                  comparison_text(found)));
  if (!builds.empty()) return kNotComparable;
  return found.difference.empty() ? kGood : kWorse;
}

// Some records of the folders: a share ("1%", one at least), or a number of them.
std::vector<std::string> sampled_records(const ReplayArguments& given) {
  std::vector<std::string> records, sample;
  for (const fs::path folder : given.records)
    for (const std::string& name : names_in(folder / "runs"))
      if (name.ends_with(".json")) records.push_back((folder / "runs" / name).string());
  require(!records.empty(), "--sample expects result folders, and these folders have no records");
  const bool is_share = given.sample.ends_with('%');
  double number = 0;
  const char *begin = given.sample.data(), *end = begin + given.sample.size() - is_share;
  require(std::from_chars(begin, end, number).ptr == end && number > 0, [&] {
    return "--sample must be a percentage such as 1% or a number such as 20, got '" + given.sample +
           "'";
  });
  if (is_share) number = std::ceil(number / 100 * double(records.size()));
  number = std::clamp(std::floor(number), 1.0, double(records.size()));
  const std::uint64_t seed = given.seed != 0 ? given.seed : std::random_device()();
  std::ranges::sample(records, std::back_inserter(sample), std::ptrdiff_t(number),
                      std::mt19937_64(seed));
  say(stdout, fmt::format("{} of {} records, sampled with --seed {}\n", sample.size(),
                          records.size(), seed));
  return sample;
}

int run(const ReplayArguments& given, Session& session) {
  int worst = kGood;
  for (const std::string& path : given.sample.empty() ? given.records : sampled_records(given)) {
    const int code = replay(path, given, session);
    if (code == kInterrupted) {
      say(stderr, "interrupted\n");
      return kInterrupted;
    }
    if (worst != kWorse && code != kGood) worst = code;
  }
  return worst;
}

}  // namespace

void register_replay(VerbRegistry& registry) {
  registry.add(verb_of<ReplayArguments>(
      {.name = "replay",
       .help_position = 28,
       .summary = "Run the cells of records again, and compare the results bit for bit",
       .examples = "  isoline replay results/quick/runs/03a4d51c22cbf199-821e62446af5cbbe.json\n"
                   "  isoline replay results/quick --sample 1%",
       .notes =
           "The cell runs in its own process, with the problem, options, seed, budget and threads "
           "of the record. Without --out, `replay` does not write any file. If a time limit or a signal ended a "
           "run, the runs are compared up to the last common iteration.\n"
           "Exit codes: 0 equal; 2 different, and the first difference is printed; 4 not "
           "comparable: another build computed the record (the parts that differ are printed), "
           "or a component is missing."},
      declare, run));
}

}  // namespace isoline::benchmarks
