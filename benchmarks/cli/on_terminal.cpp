// The live line of verbs that read many files, and the outcome of a plan.
#include "benchmarks/cli/on_terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include "benchmarks/cli/debugging.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/runner.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;

Listener on_terminal(const char* what) {
  if (Progress::style_of(STDERR_FILENO) != Progress::Style::live) return {};
  return [what, line = std::shared_ptr<Progress>()](std::size_t done, std::size_t all) mutable {
    if (line == nullptr)
      line = std::make_shared<Progress>(Progress::Style::live, what, std::int64_t(all), 0);
    line->reached(std::int64_t(done));
    line->show();
  };
}

void print_failures(const Outcome& outcome, const std::filesystem::path& folder) {
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(kMost, outcome.failures.size()); ++i)
    say(stderr, fmt::format("{}\n", outcome.failures[i]));
  if (outcome.failures.size() > kMost)
    say(stderr, fmt::format("… and {} more\n", outcome.failures.size() - kMost));
  if (outcome.crash) say(stderr, advice_on(*outcome.crash, folder));
}

void print_outcome(const Outcome& outcome, const std::filesystem::path& folder, bool quiet) {
  print_failures(outcome, folder);
  for (const std::string& name : outcome.conflicts)
    say(stderr, fmt::format("{}: its repetition gave another result\n", name));
  for (const std::string& remark : outcome.remarks) say(stderr, remark + "\n");
  if (!outcome.missing.empty())
    say(stderr, fmt::format("{} of {} vanished during the run, the first that of {}; the same "
                            "command runs what is missing\n",
                            counted(outcome.missing.size(), "record"), outcome.planned,
                            outcome.missing.front()));
  if (outcome.reused_from_other_builds > 0)
    say(stderr,
        fmt::format("{} of {} reused were run by another build\n", outcome.reused_from_other_builds,
                    counted(std::size_t(outcome.reused), "cell")));
  if (quiet) return;
  std::string counts;
  for (const auto& [status, count] : outcome.statuses)
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, name_of(status));
  say(stdout, fmt::format("{}: {} run, {} reused ({}) in {}\n",
                          counted(std::size_t(outcome.planned), "cell"), outcome.run,
                          outcome.reused, counts, duration_text(outcome.seconds)));
}

int exit_code_of(const Outcome& outcome) {
  if (outcome.is_interrupted) {
    say(stderr, "interrupted; the same command goes on where it stopped\n");
    return kInterrupted;
  }
  if (outcome.interrupted > 0) {
    say(stderr, fmt::format("{} killed from outside; the same command runs what is missing\n",
                            counted(std::size_t(outcome.interrupted), "cell")));
    return kInterrupted;
  }
  const bool is_whole = outcome.missing.empty();
  return is_whole && outcome.failures.empty() && outcome.conflicts.empty() ? kGood : kWorse;
}

}  // namespace isoline::benchmarks
