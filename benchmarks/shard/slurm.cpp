// sbatch's commands and the scripts that they wrap.
#include "benchmarks/shard/slurm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/shell.h"

namespace isoline::benchmarks {
namespace {

constexpr int kGraceSeconds = 120;  // before a task is killed: time to write checkpoints

std::string command_of(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + shell_word(word);
  return text;
}

std::string exports_of(const Submission& given) {
  if (given.environment.empty()) return "";
  std::string text = "export";
  for (const auto& [variable, value] : given.environment)
    text += " " + variable + "=" + shell_word(value);
  return text + "\n";
}

// Runs a shard. The signal of --signal=B: reaches this shell only, which forwards it and waits
// until the run has saved its state. A task that a signal ended returns to the queue: always if the
// scheduler sent it, three times if something else did, and never if the user cancelled the task,
// whose state differs then.
constexpr const char* kBefore = R"(stopped= run=
trap 'stopped=yes; kill -TERM $run' TERM
)";
constexpr const char* kAfter = R"( &
run=$!
wait $run
code=$?
while kill -0 $run 2>/dev/null; do wait $run; code=$?; done
id=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
if [ $code -gt 128 ] && { [ $stopped ] || [ ${SLURM_RESTART_COUNT:-0} -lt 3 ]; }; then
  case $(scontrol show job $id) in *JobState=RUNNING*) scontrol requeue $id ;; esac
fi
exit $code
)";

std::string task_script(const Submission& given) {
  const std::string run = command_of({given.program.string(), "run"}) + " " + command_of(given.run);
  return exports_of(given) + kBefore + run +
         fmt::format(" --shard \"$SLURM_ARRAY_TASK_ID\"/{}", given.shards) + kAfter;
}

std::string merge_script(const Submission& given) {
  const std::string program = shell_word(given.program.string());
  const std::string merged = shell_word(given.merged.string());
  return exports_of(given) +
         fmt::format("{} merge {}/*-of-{} --out {}\n", program,
                     shell_word((given.folder / "shards").string()), given.shards, merged) +
         fmt::format("{} report {}\n", program, merged);
}

// The common parts of both jobs, and the output of the wrapped script.
std::vector<std::string> shared_words(const Submission& given, const std::string& name) {
  std::vector<std::string> words = {
      "--job-name=isoline-" + given.name, "--requeue", "--open-mode=append",
      "--output=" + (given.folder / "logs" / (name + ".log")).string()};
  if (given.seconds > 0)  // in whole minutes
    words.push_back(fmt::format("--time={:.0f}", std::ceil(given.seconds / 60)));
  words.insert(words.end(), given.options.begin(), given.options.end());
  return words;
}

}  // namespace

std::string array_command(const Submission& given) {
  std::vector<std::string> words = {"sbatch", "--parsable",
                                    fmt::format("--array=1-{}", given.shards),
                                    fmt::format("--signal=B:TERM@{}", kGraceSeconds),
                                    fmt::format("--cpus-per-task={}", given.processors)};
  std::ranges::copy(shared_words(given, "task-%a"), std::back_inserter(words));
  words.push_back("--wrap=" + task_script(given));
  return command_of(words);
}

std::string merge_command(const Submission& given) {
  std::vector<std::string> words = shared_words(given, "merge");
  words.push_back("--wrap=" + merge_script(given));
  return "sbatch --parsable --dependency=afterany:\"$array\" " + command_of(words);
}

std::optional<std::size_t> most_array_size(const std::string& config) {
  constexpr const char* kDigits = "0123456789";
  const std::size_t line = config.find("MaxArraySize");
  if (line == std::string::npos) return std::nullopt;
  const std::size_t begin = config.find_first_of(kDigits, line), end = config.find('\n', line);
  if (begin == std::string::npos || begin > end) return std::nullopt;
  const std::string digits = config.substr(
      begin, std::min<std::size_t>(9, config.find_first_not_of(kDigits, begin) - begin));
  return std::stoul(digits);
}

std::size_t shards_within(const ShardLimits& limits, double seconds) {
  const std::size_t fitting = limits.array_size > 1 ? limits.array_size - 1 : 1;
  const double long_enough = std::clamp(std::floor(seconds / limits.least_seconds), 1.0, 1e9);
  return std::max<std::size_t>(
      1, std::min({limits.wanted, fitting, static_cast<std::size_t>(long_enough)}));
}

}  // namespace isoline::benchmarks
