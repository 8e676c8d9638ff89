// Words headlines, remarks, counts and commands.
#include "reports/wording.h"

#include <fmt/format.h>

#include "reports/text.h"

namespace isoline {

std::string status_text(const std::map<Status, std::size_t>& statuses) {
  std::string text;
  for (const auto& [status, count] : statuses)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name_of(status), count);
  return text;
}

std::string missing_text(const Comparison& comparison) {
  constexpr std::size_t kNamed = 5;
  const auto& missing = comparison.missing;
  if (missing.empty()) return "";
  std::string text =
      fmt::format("{} of {} cells, missing: ", comparison.answered, comparison.planned);
  for (std::size_t i = 0; i < missing.size() && i < kNamed; ++i)
    text += fmt::format("{}{} / {} / seed {}", i == 0 ? "" : "; ", missing[i].problem,
                        missing[i].optimizer, missing[i].seed);
  if (missing.size() > kNamed) text += fmt::format("; and {} more", missing.size() - kNamed);
  return text;
}

std::string headline(const Comparison& c) {
  const auto counted = [](std::size_t count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
  };
  return fmt::format("{} on {}, {}, {}", counted(c.optimizers.size(), "optimizer"),
                     counted(c.problems.size(), "problem"), counted(c.seeds.size(), "seed"),
                     counted(c.runs.size(), "run"));
}

std::vector<std::string> remarks(const Comparison& c) {
  std::vector<std::string> all;
  const Study& study = *c.study;
  if (study.superseded > 0)
    all.push_back(
        fmt::format("{} older results of the same cells were left aside.", study.superseded));
  if (!study.unreadable.empty())
    all.push_back(fmt::format("{} files could not be read; they are listed under failures.",
                              study.unreadable.size()));
  if (c.is_any_timed_together)
    all.push_back("Times marked ≈ were taken while other runs shared the machine: not comparable.");
  for (const ProblemAxis& problem : c.problems)
    if (!problem.is_minimum_declared)
      all.push_back(fmt::format(
          "{} declares no least loss: its tolerances refer to the best loss any run reached.",
          problem.spec));
  return all;
}

std::string count_text(const Cell& cell, std::size_t tolerance) {
  const Spread& work = cell.work[tolerance];
  std::string text = fmt::format("{}/{}", work.n - work.unsolved, work.n);
  if (cell.failed > 0) text += fmt::format(", {} failed", cell.failed);
  const std::size_t missing = cell.planned - cell.runs.size();
  if (missing > 0) text += fmt::format(", {} missing", missing);
  return text;
}

std::string matrix_text(const Cell& cell, std::size_t tolerance) {
  if (cell.planned == 0) return "";
  if (cell.runs.empty()) return "missing";
  if (!cell.is_measured()) return "n/a";
  return reached_figure(cell.work[tolerance].median);
}

bool is_complete(const Cell& cell, std::size_t tolerance) {
  return cell.work[tolerance].unsolved == 0 && cell.failed == 0 && cell.planned == cell.runs.size();
}

std::string rerun_command(const Request& request) {
  const Budget& budget = request.budget;
  std::string command =
      fmt::format("./isoline run --problem {} --optimizer {} --seeds ={} --iterations {}",
                  shell_word(request.problem.spec), shell_word(request.optimizer.spec),
                  request.seed, budget.iterations);
  if (budget.work < Budget{}.work) command += fmt::format(" --work {}", budget.work);
  if (budget.seconds < Budget{}.seconds) command += fmt::format(" --time {}s", budget.seconds);
  if (budget.target != Budget{}.target) command += fmt::format(" --target {}", budget.target);
  if (request.threads != 1) command += fmt::format(" --threads {}", request.threads);
  return command;
}

}  // namespace isoline
