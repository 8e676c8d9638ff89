// isoline choose DIR... --have forward,gradient: the methods that suit a user's simulator, by the
// runs of a study.
#include <fmt/format.h>

#include <algorithm>
#include <ranges>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "core/errors.h"
#include "core/results/advice.h"
#include "core/results/study.h"
#include "core/text.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

using results::Derivatives;
using results::Means;

struct ChooseArguments {
  std::vector<std::string> folders, have = {"forward"};
  int unknowns = 0;
  double noise = 0, tolerance = 1e-6;
  bool bounds = false;
  std::int64_t budget = kMostAmount;
};

void declare(VerbArguments& verb, ChooseArguments& given) {
  std::vector<std::string> offers(results::kDerivativeNames.begin(),
                                  results::kDerivativeNames.end());
  offers.emplace_back("inverse");
  verb.texts("DIR", given.folders, kFolders).required();
  verb.texts("--have", given.have,
             "What your simulator computes: forward, gradient, jacobian or hessian, each of which "
             "includes the ones before it, and inverse")
      .one_of(offers)
      .between_commas()
      .shown("forward");
  verb.whole(
      "--unknowns", given.unknowns,
      "Number of unknowns of your problem. Only problems of the same class are used: up to 10, 11 "
      "to 100, more than 100 (default: all problems)",
      {.low = 0, .high = 1'000'000'000});
  verb.real("--noise", given.noise, between(0, 10),
            "Noise in the data, relative to the root mean square of the data");
  verb.flag("--bounds", given.bounds, "The unknowns have bounds");
  verb.whole("--budget", given.budget,
             "Number of forward solves that a run may cost (default: any)");
  verb.real("--tolerance", given.tolerance, between(1e-10, 1),
            "Relative tolerance, as in `isoline report`")
      .shown("1e-6");
}

Means means_of(const ChooseArguments& given) {
  Means means{.noise = given.noise, .has_bounds = given.bounds};
  for (const std::string& one : given.have) {
    const auto at = std::ranges::find(results::kDerivativeNames, one);
    if (at == results::kDerivativeNames.end()) means.has_inverse = true;
    if (at != results::kDerivativeNames.end())
      means.derivatives = std::max(
          means.derivatives, static_cast<Derivatives>(at - results::kDerivativeNames.begin()));
  }
  if (given.budget < kMostAmount) means.budget = static_cast<Real>(given.budget);
  for (const auto& [least, most] : results::kSizeClasses)
    if (given.unknowns > 0 && given.unknowns >= least && given.unknowns <= most) {
      means.least_unknowns = least;
      means.most_unknowns = most;
    }
  return means;
}

int run(const ChooseArguments& given, Session&) {
  const results::Study study =
      reports::read_study(given.folders, progress_on_terminal("reading records"));
  require(!study.runs.empty(), "no records; `isoline run --out FOLDER` creates some");
  const results::Comparison comparison = results::compare_optimizers(
      study, reports::yardstick_at(reports::Measure::work, given.tolerance));
  const Means means = means_of(given);
  const results::Advice advice = results::advise(comparison, means);
  require(!advice.settings.empty(), [&] {
    return reports::means_text(means) + ": these results do not have such a problem";
  });
  say(stdout, reports::advice_text(comparison, means, advice) + "\n");
  constexpr std::size_t kShown = 10;
  for (const results::Advised& one : advice.ranked | std::views::take(kShown))
    say(stdout,
        fmt::format("  {} {:28} solves {:2}/{}  work {:>8}  score {:.2f}\n",
                    one.is_in_group ? '*' : ' ', comparison.optimizers[one.optimizer].name_of_all(),
                    one.solved, advice.settings.size(),
                    one.work < results::kNever ? reports::figure(one.work) : "–", one.score));
  if (!advice.ranked.empty()) say(stdout, reports::words("advice.legend") + "\n");
  if (given.unknowns > 0) say(stdout, reports::words("advice.size-class") + "\n");
  return kGood;
}

}  // namespace

void register_choose(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "choose",
       .help_position = 45,
       .summary = "Name the methods that suit your simulator, based on the runs of a study",
       .examples = "  isoline choose results/quick --have forward,gradient --unknowns 50\n"
                   "  isoline choose results/quick --have forward --budget 1000",
       .notes = "The first sentence is also in the report, in the tab 'Choose a method'. Methods "
                "marked * are not significantly worse than the first one."},
      declare, run));
}

}  // namespace isoline::benchmarks
