// isoline replay RECORD...: runs the cells of records again and compares each two bit for bit.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "benchmarks/cli/command_line.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/build_parts.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/store.h"
#include "core/draws.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct ReplayArguments {
  std::vector<std::string> records;
  std::string sample;             // "1%", "20"; empty: all that are named
  std::uint64_t seed = 0;         // of the sample; 0: drawn
  std::int64_t memory_bytes = 0;  // 0: as the runner has it
};

void declare(VerbArguments& verb, ReplayArguments& given) {
  verb.texts("RECORD", given.records,
             "Records of `isoline run`: files in runs/; with --sample result folders")
      .required();
  verb.text("--sample", given.sample,
            "Replay so many records of result folders, drawn at random: 1%, or 20");
  verb.seed("--seed", given.seed, "Seed of the sample; 0: another one each time, which is printed");
  verb.memory("--memory", given.memory_bytes, "Most memory of a cell (default: 4GB)");
  verb.plugins();
}

// A limit for a machine that may be slower, and busy.
double most_seconds_of(const Record& record) {
  constexpr double kLeast = 60, kSlower = 10;
  return std::max(kLeast, kSlower * record.summary.wall_seconds);
}

// Why the two were not made by the same program on the same platform; empty where they were.
std::string difference_of_builds(const Record& record, const Request& request) {
  if (record.cell != request.cell)
    return "this program has other options: the request is another cell";
  if (record.build == build_digest(request)) return "";
  std::string parts;
  for (const auto& [part, digest] : build_parts(request)) {
    const auto stored = record.build_parts.find(part);
    if (stored != record.build_parts.end() && stored->second == digest) continue;
    parts += (parts.empty() ? "" : ", ") + part;
  }
  return "another build computed it, which differs in: " + parts;
}

// One run of the request; no record if it was stopped or killed.
struct Rerun {
  std::optional<Record> record;
  bool is_interrupted = false;
};
Rerun run_again(const Request& request, const Record& kept, const ReplayArguments& given,
                Session& session) {
  const HiddenFolder folder;
  Store store(folder.path());
  RunOptions options{.force = true,
                     .keeps_fields = kept.fields.has_value(),
                     .keeps_spectra = kept.spectrum.has_value(),
                     .command = session.command()};
  if (given.memory_bytes > 0) options.limits.memory_bytes = given.memory_bytes;
  const Outcome outcome = run_all(session.catalog(), {request}, store, options);
  return {store.find(request), outcome.is_interrupted};
}

std::string comparison_text(const Comparison& found) {
  if (!found.difference.empty()) return "differs: " + found.difference;
  if (found.is_up_to_there)
    return fmt::format("equal up to iteration {}, where a clock or a kill ended one of them",
                       found.iterations);
  return fmt::format("equal, {} iteration{}", found.iterations, found.iterations == 1 ? "" : "s");
}

// The exit code of one record.
int replay(const std::string& path, const ReplayArguments& given, Session& session) {
  require(!fs::is_directory(path), [&] {
    return fmt::format("{} is a folder: name records, such as those in its runs/", path);
  });
  const Record record = read_unchecked_record(path);
  const std::string title = fmt::format("{}: {}", path, title_of(record.request));
  Request request;
  try {
    request = request_again(session.catalog(), record, most_seconds_of(record));
  } catch (const UsageError& error) {
    say(stdout, fmt::format("{}: not comparable: {}\n", title, error.what()));
    return kNotComparable;
  }
  const std::string builds = difference_of_builds(record, request);
  const auto [again, is_interrupted] = run_again(request, record, given, session);
  if (is_interrupted) return kInterrupted;
  if (!again) {
    say(stdout, fmt::format("{}: not comparable: it was killed from outside\n", title));
    return kNotComparable;
  }
  Record same_asked = *again;
  same_asked.cell = record.cell;  // compared above
  same_asked.request = record.request;
  const Comparison found = compare_results(record, same_asked);
  say(stdout,
      fmt::format("{}: {}{}\n", title, builds.empty() ? "" : "not comparable: " + builds + "; ",
                  comparison_text(found)));
  if (!builds.empty()) return kNotComparable;
  return found.difference.empty() ? kGood : kWorse;
}

// How many of so many: "1%" of them, one at least, or the number itself.
std::size_t sample_size(const std::string& asked, std::size_t all) {
  const bool is_share = asked.ends_with('%');
  const double number =
      read_real("--sample", is_share ? asked.substr(0, asked.size() - 1) : asked, above(0));
  const double wanted = is_share ? std::ceil(number / 100 * double(all)) : std::floor(number);
  return std::min(all, static_cast<std::size_t>(std::max(wanted, 1.0)));
}

// Records of the folders, without any twice, in the order drawn.
std::vector<std::string> sampled_records(const ReplayArguments& given) {
  std::vector<std::string> records;
  for (const fs::path folder : given.records)
    for (const std::string& name : names_in(folder / "runs"))
      if (name.ends_with(".json")) records.push_back((folder / "runs" / name).string());
  require(!records.empty(), "--sample takes result folders, and there is no record in these");
  std::ranges::sort(records);
  const std::uint64_t seed = given.seed != 0 ? given.seed : std::random_device()();
  const std::size_t count = sample_size(given.sample, records.size());
  Draws random(seed, "replay", "sample");
  for (std::size_t i = 0; i < count; ++i)
    std::swap(records[i],
              records[i + static_cast<std::size_t>(random.uniform(0, double(records.size() - i)))]);
  say(stdout, fmt::format("{} of {} records, drawn with --seed {}\n", count, records.size(), seed));
  records.resize(count);
  return records;
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
  registry.add(verb_of(
      {.name = "replay",
       .help_position = 60,
       .summary = "Run the cells of records again, and check each two for equality bit for bit",
       .examples = "  isoline replay results/quick/runs/03a4d51c22cbf199-821e62446af5cbbe.json\n"
                   "  isoline replay results/quick --sample 1%",
       .notes =
           "The cell runs in its own process, with the problem, options, seed, budget and threads "
           "of\n"
           "the record. Nothing is written. A record that a clock or a kill ended is compared up "
           "to the last\n"
           "common iteration. Exit codes: 0 equal; 2 different, with the first difference named;\n"
           "4 not comparable: another build computed it, with its parts named, or the record's "
           "component is\n"
           "not there."},
      declare, run));
}

}  // namespace isoline::benchmarks
