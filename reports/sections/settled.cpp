// What a report settles, what it does not, and what was not run: three sentences of its first
// screen; and those on what was learned.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "reports/read/ranking.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/leading.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string settled(const Comparison& c) {
  if (!has_order(c) || !c.lead) return "No order of methods: too few problems were given to all.";
  const Lead& lead = *c.lead;
  if (lead.told() == 0) return "No method can be told from the first over these problems.";
  std::vector<std::string> names;
  constexpr std::size_t kNamed = 4;
  for (const Rival& rival : lead.rivals)
    if (rival.is_told() && names.size() < kNamed)
      names.push_back(optimizer_text(c, rival.optimizer));
  const std::size_t more = lead.told() - names.size();
  return fmt::format("{} needs less {} than {}{}: so much holds after Holm at 0.05.",
                     first_text(c, lead), counted_name(c), joined(names),
                     more > 0 ? fmt::format(" and {} others", more) : "");
}

std::string open(const Comparison& c) {
  if (!has_order(c) || !c.lead) return "Every order.";
  const Lead& lead = *c.lead;
  std::string text = settled_text(c, lead);
  if (c.seeds.size() < kFewestForInterval)
    text += fmt::format(" With {} every interval over seeds is a range.",
                        counted(c.seeds.size(), "seed"));
  return text + " Problems unlike these were not drawn.";
}

std::string not_run(const Comparison& c) {
  std::size_t pairs = 0, never = 0, inapplicable = 0;
  for (const auto& row : c.cells)
    for (const Cell& cell : row) {
      ++pairs;
      never += cell.planned == 0;
      inapplicable += !cell.inapplicable.empty();
    }
  if (never == 0 && inapplicable == 0 && c.missing.empty())
    return fmt::format("Nothing: all {} pairs of method and problem ran.", pairs);
  std::string text = fmt::format(
      "Of {} pairs of method and problem {} were never planned, {} do not "
      "apply",
      pairs, never, inapplicable);
  if (!c.missing.empty())
    text += fmt::format("; {} planned {} missing", counted(c.missing.size(), "run"),
                        c.missing.size() == 1 ? "is" : "are");
  return text + ".";
}

}  // namespace

std::string short_verdict(const Comparison& c) {
  const std::vector<std::string> sentences = verdict(c);
  const bool is_led = has_order(c) && c.lead && c.lead->tied == 1;
  if (!is_led || sentences.empty()) return sentences.empty() ? "" : sentences[0];
  const Scored& first = c.lead->ranked[0];
  return fmt::format("Of {}, {} stands first, and its lead is {}: it {}.", field_text(c, *c.lead),
                     optimizer_text(c, first.optimizer),
                     c.lead->is_settled ? "settled" : "not settled", deeds_text(c, first));
}

std::vector<Reading> settled_readings(const Comparison& c) {
  return {{"Settled", settled(c)}, {"Not settled", open(c)}, {"Not run", not_run(c)}};
}

namespace {

// On how many of the learned problems each is nearest in x, those with the most first.
std::string nearest_text(const std::map<std::string, std::size_t>& nearest, std::size_t problems) {
  std::vector<std::pair<std::string, std::size_t>> ranked(nearest.begin(), nearest.end());
  std::ranges::stable_sort(ranked, std::ranges::greater{},
                           &std::pair<std::string, std::size_t>::second);
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> parts;
  for (const auto& [name, count] : ranked)
    if (parts.size() < kNamed) parts.push_back(fmt::format("{} on {}", name, count));
  return fmt::format("At equal work, of {}, nearest in x: {}.",
                     counted(problems, "learned problem"), joined(parts));
}

}  // namespace

std::vector<std::string> learned_sentences(const Comparison& c) {
  constexpr std::size_t kFew = 4;
  std::vector<std::string> all;
  std::map<std::string, std::size_t> nearest;
  std::size_t problems = 0;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    if (!c.problems[p].is_learned) continue;
    const EqualWork equal = equal_work(c, p);
    const auto order = equal.nearest_first();
    if (order.empty() || !equal.methods[order[0]]->x_error.is_solved()) continue;
    ++problems;
    ++nearest[optimizer_text(c, order[0])];
    const Real least = equal.methods[order[0]]->x_error.median;
    std::string text =
        fmt::format("{}, learned: at equal work {} is nearest in x, at {}",
                    problem_name(c.problems[p]), optimizer_text(c, order[0]), figure(least));
    if (order.size() > 1)
      text += fmt::format("; next {}, {} as far", optimizer_text(c, order[1]),
                          multiple(equal.methods[order[1]]->x_error.median / least));
    if (all.size() < kFew) all.push_back(text + ".");
  }
  if (problems > 1) all.insert(all.begin(), nearest_text(nearest, problems));
  return all;
}

}  // namespace isoline::reports
