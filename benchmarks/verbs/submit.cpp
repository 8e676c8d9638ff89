// isoline submit --slurm: a run in shards, handed to a cluster's scheduler as two jobs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "benchmarks/cli/command_line.h"
#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/shard/slurm.h"
#include "benchmarks/shard/split.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"
#include "core/threads.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct SubmitArguments {
  std::vector<std::string> run;      // what stands after `isoline run`
  std::vector<std::string> options;  // of sbatch
  std::string partition;
  double seconds = 0, least_seconds = 300;  // 0: the partition's limit
  int tasks = 16;
  bool is_slurm = false, is_agreed = false;
};

void declare(VerbArguments& verb, SubmitArguments& given) {
  verb.texts("RUN", given.run, "After --, the arguments of `isoline run`");
  verb.flag("--slurm", given.is_slurm, "Use SLURM, which this machine must reach");
  verb.whole("--array", given.tasks,
             "Largest number of tasks; MaxArraySize and --least may lower it", kShards);
  verb.time("--time", given.seconds,
            "Time limit of a task: 2h; an unfinished task continues in the next one "
            "(default: the partition's)");
  verb.time("--least", given.least_seconds, "Smallest predicted time of a task (default: 5m)");
  verb.text("--partition", given.partition, "Partition (default: the cluster's)");
  verb.texts("--sbatch", given.options, "A further option of sbatch: --sbatch=--account=physics")
      .one_each();
  verb.flag("--yes", given.is_agreed, "Submit the two jobs instead of printing them");
}

struct Answer {
  std::string text;  // of standard output; standard error is the caller's
  bool is_good = false;
};

Answer answer_of(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  require(pipe != nullptr, [&] { return "cannot start a shell for: " + command; });
  Answer answer;
  for (int letter; (letter = std::fgetc(pipe)) != EOF;) answer.text += static_cast<char>(letter);
  answer.is_good = pclose(pipe) == 0;
  return answer;
}

std::size_t array_size_here() {
  const auto told = most_array_size(answer_of("scontrol show config 2>/dev/null").text);
  if (told) return *told;
  const std::size_t standard = ShardLimits().array_size;
  say(stderr,
      fmt::format("scontrol reports no MaxArraySize; using SLURM's default, {}\n", standard));
  return standard;
}

// This very program, under a name of its own: a later build leaves it alone.
fs::path kept_program(const fs::path& folder) {
  const std::string bytes = read_text("/proc/self/exe");
  const fs::path program = folder / "program" / ("isoline-" + digest(bytes));
  if (is_there(program)) return program;
  write_text(program, bytes);
  fs::permissions(program, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                               fs::perms::others_read | fs::perms::others_exec);
  return program;
}

// One choice for all tasks, whatever processors they come to.
std::vector<std::pair<std::string, std::string>> fixed_kernels() {
  std::vector<std::pair<std::string, std::string>> all{
      {"OPENBLAS_CORETYPE", library_kernel().name}};
  if (const std::string isa = of_this_process("ONEDNN_MAX_CPU_ISA"); !isa.empty())
    all.emplace_back("ONEDNN_MAX_CPU_ISA", isa);
  return all;
}

// A folder that is not there yet: merged, merged-2, …
fs::path free_folder(const fs::path& whole) {
  fs::path folder = whole / "merged";
  for (int i = 2; is_there(folder); ++i) folder = whole / fmt::format("merged-{}", i);
  return folder;
}

// The words of the run, with what a task must have besides.
std::vector<std::string> run_words(const SubmitArguments& given, const RunArguments& run,
                                   const fs::path& folder) {
  std::vector<std::string> words = given.run;
  if (run.out.empty()) words.insert(words.end(), {"--out", folder.string()});
  if (run.jobs == 0) words.insert(words.end(), {"--jobs", "1"});
  if (!run.quiet) words.emplace_back("--quiet");
  return words;
}

Submission submission_of(const SubmitArguments& given, const RunArguments& run,
                         const PlannedRun& all, std::size_t shards) {
  const fs::path folder = fs::absolute(all.folder).lexically_normal();
  for (const char* part : {"logs", "program", "shards"}) {
    std::error_code error;
    fs::create_directories(folder / part, error);
    require(!error, [&] {
      return fmt::format("cannot create {}: {}", (folder / part).string(), error.message());
    });
  }
  Submission all_of_it{.name = all.name,
                       .program = kept_program(folder),
                       .folder = folder,
                       .merged = free_folder(folder),
                       .run = run_words(given, run, folder),
                       .environment = fixed_kernels(),
                       .shards = shards,
                       .processors = std::max(1, run.jobs) * std::max(1, run.threads),
                       .seconds = given.seconds,
                       .options = {}};
  if (!given.partition.empty()) all_of_it.options.push_back("--partition=" + given.partition);
  std::ranges::copy(given.options, std::back_inserter(all_of_it.options));
  return all_of_it;
}

// The number of a job, from "123" or "123;cluster", or empty.
std::string job_from(const Answer& answer) {
  if (!answer.is_good) return "";
  return answer.text.substr(0, answer.text.find_first_not_of("0123456789"));
}

int submit(const Submission& submission) {
  const std::string array = job_from(answer_of(array_command(submission)));
  if (array.empty()) {
    say(stderr, "sbatch refused the array; nothing was submitted\n");
    return kWorse;
  }
  setenv("array", array.c_str(), 1);
  const std::string merge = job_from(answer_of(merge_command(submission)));
  if (merge.empty()) {
    say(stderr,
        fmt::format("sbatch accepted the array, job {}, but refused the merge: `isoline merge` "
                    "does it by hand\n",
                    array));
    return kWorse;
  }
  const std::string folder = submission.folder.string();
  say(stdout,
      fmt::format("submitted: job {} ({}), then job {}, which merges and reports into {}\n", array,
                  reports::counted(submission.shards, "task"), merge, submission.merged.string()));
  say(stdout, fmt::format("`isoline status {}` tells how far they are\n", folder));
  return kGood;
}

void warn_of_build() {
  if (library_kernel().chosen_by == "portable") return;
  say(stderr,
      "this program was compiled for this machine's processor: it may not start on other nodes; "
      "the preset `portable` runs on all of them\n");
}

// Parses the words after `--` as `isoline run` would.
RunArguments run_arguments(const std::vector<std::string>& words, Session& session) {
  RunArguments run;
  Verb verb{.name = "run"};
  verb.declare = [&](VerbArguments& arguments) { declare_run(arguments, run); };
  read_arguments("isoline submit --", verb, words, session);
  return run;
}

// For all cells, one at a time; cells without a prediction count as the mean of the others;
// infinite if no cell has a prediction.
double seconds_of(const Preview& shown) {
  double seconds = 0, known = 0;
  for (const PreviewedCell& cell : shown.cells) {
    seconds += cell.seconds.value_or(0);
    known += cell.seconds.has_value();
  }
  return known > 0 ? seconds / known * static_cast<double>(shown.cells.size()) : INFINITY;
}

int run(const SubmitArguments& given, Session& session) {
  require(given.is_slurm, "name the scheduler: --slurm is the only one");
  const RunArguments run = run_arguments(given.run, session);
  require(run.shard.empty(), "--shard differs for each task: leave it out after --");
  require(!run.is_dry && !run.in_process, "a task writes records: no --dry-run, no --in-process");
  const PlannedRun all = planned_run(run, session.catalog());
  Preview shown = preview_of(all, run, {}, result_folders(all.folder), session);
  keep_predictions(all.folder, shown);
  const int jobs = std::max(1, run.jobs);
  const double seconds = seconds_of(shown) / jobs;
  const std::size_t shards = shards_within({.wanted = static_cast<std::size_t>(given.tasks),
                                            .array_size = array_size_here(),
                                            .least_seconds = given.least_seconds},
                                           seconds);
  const Submission submission = submission_of(given, run, all, shards);
  warn_of_build();
  const auto about = [](double each) {
    return std::isfinite(each) ? " of about " + duration_text(each) : "";
  };
  say(stderr,
      fmt::format("{}{}: {}{}{}\n", reports::counted(all.requests.size(), "cell"), about(seconds),
                  reports::counted(shards, "task"), about(seconds / static_cast<double>(shards)),
                  std::isfinite(seconds) ? "" : "; no earlier run tells how long they take"));
  if (given.is_agreed) return submit(submission);
  say(stdout,
      fmt::format("array=$({})\n{}\n", array_command(submission), merge_command(submission)));
  say(stderr, "nothing was submitted; --yes submits these two jobs\n");
  return kGood;
}

}  // namespace

void register_submit(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "submit",
       .help_position = 80,
       .summary = "Submit a run to a cluster's scheduler, as two jobs",
       .examples =
           "  isoline submit --slurm --array 16 --time 2h -- quick --seeds 20      prints two "
           "jobs\n"
           "  isoline submit --slurm --partition long --yes -- sip-paper           submits them",
       .notes =
           "The first job is an array with one task per shard; the second merges and reports "
           "after all tasks.\n"
           "The program, the kernels of its libraries and the predictions for the division are "
           "stored in\n"
           "the result folder, which all nodes must see. A task that the scheduler stops saves "
           "the state of\n"
           "its cells, returns to the queue and continues.\n"
           "Exit codes: 0 good, 1 wrong usage, 2 the scheduler refused."},
      declare, run));
}

}  // namespace isoline::benchmarks
