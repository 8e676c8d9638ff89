// Words headlines, remarks, counts and commands.
#include "reports/wording.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/text.h"

namespace isoline::reports {

std::string status_meaning(Status status) {
  switch (status) {
    case Status::converged:
      return "stopped by the method's own test";
    case Status::target:
      return "reached the target loss of the run";
    case Status::budget:
      return "used up their work or iterations";
    case Status::stalled:
      return "stopped making progress";
    case Status::diverged:
      return "blew up: not finite, or 1e12 times the start";
    case Status::inapplicable:
      return "make no sense for the problem";
    case Status::failed:
      return "ended in an error";
    case Status::crashed:
      return "killed their process";
    case Status::timeout:
      return "were stopped at the time limit";
    case Status::memory:
      return "ran out of memory";
    case Status::interrupted:
      return "were interrupted";
    case Status::running:
      break;
  }
  return "did not end";
}

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
  std::string problems = counted(c.names, "problem");
  if (c.problems.size() > c.names) problems += fmt::format(" ({} settings)", c.problems.size());
  return fmt::format("{} on {}, {}, {}", counted(c.optimizers.size(), "optimizer"), problems,
                     counted(c.seeds.size(), "seed"), counted(c.runs.size(), "run"));
}

namespace {

// "heat: 17, heat[N=16]: 12" where some problems were not asked of every optimizer; else empty.
std::string partial_rows(const Comparison& c) {
  constexpr std::size_t kNamed = 8;
  std::vector<std::string> rows;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const auto planned =
        std::ranges::count_if(c.cells[p], [](const Cell& x) { return x.planned > 0; });
    if (static_cast<std::size_t>(planned) < c.optimizers.size())
      rows.push_back(fmt::format("{}: {}", shown_spec(c.problems[p].spec), planned));
  }
  const std::size_t more = rows.size() > kNamed ? rows.size() - kNamed : 0;
  rows.resize(rows.size() - more);
  return fmt::format("{}{}", fmt::join(rows, ", "),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace

std::vector<std::string> remarks(const Comparison& c) {
  std::vector<std::string> all;
  const Study& study = *c.study;
  if (const std::string rows = partial_rows(c); !rows.empty())
    all.push_back(fmt::format(
        "Not every problem was given to every optimizer, as where a grid is too large for methods "
        "that factorize a matrix or take no derivatives. An empty cell was never planned and "
        "counts "
        "for nobody: work is compared within one problem, and each optimizer is judged on the "
        "problems given to it. Optimizers by problem, of {}: {}.",
        c.optimizers.size(), rows));
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
          shown_spec(problem.spec)));
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

std::string budget_options(const Request& request) {
  const Budget& budget = request.budget;
  std::string options = fmt::format("--iterations {}", budget.iterations);
  if (budget.work < Budget{}.work) options += fmt::format(" --work {}", budget.work);
  if (budget.seconds < Budget{}.seconds) options += fmt::format(" --time {}s", budget.seconds);
  if (budget.target != Budget{}.target) options += fmt::format(" --target {}", budget.target);
  if (request.threads != 1) options += fmt::format(" --threads {}", request.threads);
  return options + " --rates none";
}

std::string rerun_command(const Request& request) {
  return fmt::format("./isoline run --problem {} --optimizer {} --seeds ={} {}",
                     shell_word(request.problem.spec), shell_word(request.optimizer.spec),
                     request.seed, budget_options(request));
}

}  // namespace isoline::reports
