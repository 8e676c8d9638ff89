// The phrases of a comparison that every format uses.
#include <fmt/format.h>

#include <cmath>

#include "reports/comparison.h"
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
