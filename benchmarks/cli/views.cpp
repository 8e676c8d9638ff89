// The views of a study: correct digits, and the methods that suit a simulator.
#include "benchmarks/cli/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>
#include <utility>

#include "core/errors.h"
#include "core/results/advice.h"
#include "core/results/published_digits.h"
#include "core/results/study.h"
#include "core/results/table.h"
#include "core/text.h"
#include "reports/formats/formats.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

using results::Derivatives;
using results::Means;

// --- the methods that suit a simulator

Means means_of(const View& view) {
  Means means{.noise = view.noise, .has_bounds = view.bounds, .has_failures = view.failures};
  for (const std::string& one : view.have) {
    const auto at = std::ranges::find(results::kDerivativeNames, one);
    if (at == results::kDerivativeNames.end()) means.has_inverse = true;
    if (at != results::kDerivativeNames.end())
      means.derivatives = std::max(
          means.derivatives, static_cast<Derivatives>(at - results::kDerivativeNames.begin()));
  }
  if (view.budget < kMostAmount) means.budget = static_cast<Real>(view.budget);
  for (const auto& [least, most] : results::kSizeClasses)
    if (view.unknowns > 0 && view.unknowns >= least && view.unknowns <= most) {
      means.least_unknowns = least;
      means.most_unknowns = most;
    }
  return means;
}

void print_choice(const results::Study& study, const View& view) {
  const results::Comparison comparison = results::compare_optimizers(
      study, reports::yardstick_at(reports::Measure::work, view.tolerance));
  const Means means = means_of(view);
  const results::Advice advice = results::advise(comparison, means);
  require(!advice.settings.empty(), [&] {
    const bool are_bounded =
        !means.has_bounds &&
        std::ranges::any_of(comparison.problems, &results::ProblemAxis::is_bounded);
    return reports::means_text(means) + ": these results do not have such a problem" +
           (are_bounded ? "; for problems with bounds, add --bounds" : "");
  });
  say(stdout, reports::advice_text(comparison, means, advice) + "\n");
  constexpr std::size_t kShown = 10;
  for (const results::Advised& one : advice.ranked | std::views::take(kShown))
    say(stdout,
        fmt::format("  {} {:28} solves {:2}/{}  work {:>8}  score {:.2f}\n",
                    one.is_in_group ? '*' : ' ', reports::advised_name(comparison, one), one.solved,
                    advice.settings.size(),
                    one.work < results::kNever ? reports::figure(one.work) : "–", one.score));
  if (!advice.ranked.empty()) say(stdout, reports::words("advice.legend") + "\n");
  if (view.unknowns > 0) say(stdout, reports::words("advice.size-class") + "\n");
}

// --- the correct digits of results

std::string published_means() {
  std::string means;
  for (const auto& [name, mean] : results::kPublishedDigits)
    means += fmt::format("{}{} {:.1f}", means.empty() ? "" : ", ", name, mean);
  return fmt::format("Published mean LRE (header of nist.cc of Ceres): {}.\n", means);
}

constexpr const char* kMeaning =
    "LRE: the log relative error, about the number of correct digits of the least accurate "
    "parameter,\nfrom 0 to 11; forwards: the forward solves of all runs.\n";

// The log relative errors of a method over its settings, at the points that it returned.
struct Score {
  std::string name;
  std::size_t runs = 0, solved = 0, precise = 0;
  Real digits = 0, calls = 0;  // their sums
};

Score score_of(const results::Table& table, std::size_t optimizer) {
  const results::OptimizerAxis& axis = table.optimizers[optimizer];
  Score score{.name = axis.label + results::marks_text(axis.marks())};
  for (const results::Run& run : table.runs) {
    const Record& record = *run.record;
    if (run.optimizer != optimizer || !record.x_scale || record.status == Status::inapplicable)
      continue;
    const Real lre = results::returned_digits(record);
    ++score.runs;
    score.solved += lre >= results::kSolvedDigits;
    score.precise += lre >= results::kAccurateDigits;
    score.digits += lre;
    score.calls += static_cast<Real>(record.counts[static_cast<std::size_t>(Oracle::forward)]);
  }
  score.digits /= static_cast<Real>(std::max<std::size_t>(score.runs, 1));
  return score;
}

void print_digits(const results::Study& study) {
  const results::Table table = results::table_of(study);
  std::vector<Score> scores;
  for (std::size_t s = 0; s < table.optimizers.size(); ++s)
    if (Score score = score_of(table, s); score.runs > 0) scores.push_back(std::move(score));
  require(!scores.empty(),
          "no digits to count: none of these problems has a known solution. Declare its x, in a "
          "script as the argument truth of isoline.problem");
  std::ranges::stable_sort(scores, [](const Score& a, const Score& b) {
    return std::pair(a.solved, a.digits) > std::pair(b.solved, b.digits);
  });
  std::size_t width = 0;
  for (const Score& each : scores) width = std::max(width, each.name.size());
  say(stdout, fmt::format("{:{}}  LRE ≥ 4  LRE ≥ 6  mean LRE  forwards\n", "", width));
  for (const Score& each : scores)
    say(stdout,
        fmt::format("{:{}}  {:>7}  {:>7}  {:8.2f}  {:8.0f}\n", reports::terminal_text(each.name),
                    width, fmt::format("{}/{}", each.solved, each.runs),
                    fmt::format("{}/{}", each.precise, each.runs), each.digits, each.calls));
  const bool is_nist = std::ranges::all_of(
      study.runs, [](const Record& record) { return record.request.problem.name == "nist"; });
  if (is_nist) say(stdout, published_means());
  say(stdout, kMeaning);
}

}  // namespace

Argument declare_view(VerbArguments& verb, std::string& name) {
  return verb
      .text(
          "--view", name,
          "Print instead of the ranking: digits, the numbers of correct digits of the methods, or "
          "choice, the methods that suit your simulator")
      .one_of({"digits", "choice"});
}

void declare_choice(VerbArguments& verb, const Argument& choice, View& view) {
  std::vector<std::string> offers(results::kDerivativeNames.begin(),
                                  results::kDerivativeNames.end());
  offers.emplace_back("inverse");
  verb.texts("--have", view.have,
             "What your simulator computes: forward, gradient, jacobian or hessian, each of which "
             "includes the ones before it, and inverse")
      .one_of(offers)
      .between_commas()
      .shown("forward")
      .needs(choice);
  verb.whole(
          "--unknowns", view.unknowns,
          "Number of unknowns of your problem. Only problems of the same class are used: up to 10, 11 "
          "to 100, more than 100 (default: all problems)",
          {.low = 0, .high = 1'000'000'000})
      .needs(choice);
  verb.real("--noise", view.noise, between(0, 10),
            "Noise in the data, relative to the root mean square of the data")
      .needs(choice);
  verb.flag("--bounds", view.bounds, "The unknowns have bounds").needs(choice);
  verb.flag("--failures", view.failures, "Some calls of the simulator fail").needs(choice);
  verb.whole("--budget", view.budget, "Number of forward solves that a run may cost (default: any)")
      .needs(choice);
}

void print_view(const results::Study& study, const View& view) {
  if (view.name == "digits")
    print_digits(study);
  else
    print_choice(study, view);
}

}  // namespace isoline::benchmarks
