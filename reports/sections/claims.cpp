// The verdicts on claims of papers, and the figures they rest on.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"
#include "reports/statistics/resampling.h"

namespace isoline::reports {
namespace {

constexpr const char* kNothing = "–";

std::string value_text(const Judgement& judgement) {
  return judgement.measured ? figure(judgement.measured->value) : kNothing;
}

std::string interval_text(const Judgement& judgement) {
  const auto& measured = judgement.measured;
  if (!measured || std::isnan(measured->low)) return kNothing;
  return fmt::format("{}–{}", figure(measured->low), figure(measured->high));
}

// "10–30 (range of 3)": so few seeds have no interval.
std::string over_seeds(const Judgement& judgement) {
  std::string text = interval_text(judgement);
  if (text == kNothing || judgement.measured->n >= kFewestForInterval) return text;
  return fmt::format("{} ({})", text, interval_name(judgement.measured->n));
}

std::string_view mark_of(Verdict verdict) {
  constexpr std::array<std::string_view, kVerdictNames.size()> kMarks = {"✓", "∼", "≈",
                                                                         "✗", "…", "·"};
  return kMarks[static_cast<std::size_t>(verdict)];
}

std::string remarks_of(const Judgement& judgement) {
  std::vector<std::string> parts;
  for (const Reading& note : claim_notes(judgement)) parts.push_back(note.text);
  return joined(parts, " ");
}

std::vector<TableCell> row_of(const Judgement& judgement) {
  TableCell claim = judgement.sentence;
  claim.note = judgement.quantity;
  claim.remark = judgement.source;
  claim.link = "#claim-" + judgement.id;
  return {claim,
          marked_verdict(judgement),
          judgement.published,
          value_text(judgement),
          over_seeds(judgement),
          judgement.measured ? std::to_string(judgement.measured->n) : kNothing,
          remarks_of(judgement)};
}

}  // namespace

std::string measured_text(const Judgement& judgement) {
  if (!judgement.measured) return kNothing;
  const std::string interval = interval_text(judgement);
  return fmt::format("{}{}, n = {}", value_text(judgement),
                     interval == kNothing ? "" : fmt::format(" ({})", interval),
                     judgement.measured->n);
}

std::string marked_verdict(const Judgement& judgement) {
  return fmt::format("{} {}", mark_of(judgement.verdict), verdict_text(judgement));
}

// What a reader must know beside the figures: what it was held against, why not, and what differs
// from the source.
std::vector<Reading> claim_notes(const Judgement& judgement) {
  std::vector<Reading> notes;
  if (const auto& contrast = judgement.contrast)
    notes.push_back({"Contrast", fmt::format("Checked against the {}: published {}, measured {}.",
                                             contrast->quantity, contrast->published,
                                             contrast->measured ? figure(contrast->measured->value)
                                                                : kNothing)});
  if (!judgement.why.empty()) notes.push_back({"Why", judgement.why + "."});
  if (!judgement.survives.empty())
    notes.push_back({"Not refutable",
                     fmt::format("The data could not refute it: {} would come to the same verdict.",
                                 joined(judgement.survives, " and "))});
  if (judgement.fact != judgement.id)
    notes.push_back({"Fact", fmt::format("Counted with {}.", judgement.fact)});
  if (!judgement.caveat.empty()) notes.push_back({"Caveat", judgement.caveat});
  return notes;
}

std::string verdict_text(const Judgement& judgement) {
  std::string text(name_of(judgement.verdict));
  if (is_decided(judgement.verdict) && judgement.is_drawn)
    text += " on " + counted(judgement.measured->n, "seed");
  return text;
}

std::string claims_reading(const std::vector<Judgement>& judgements) {
  const std::vector<Verdict> facts = verdicts_on_facts(judgements);
  const auto count = [&](Verdict verdict) { return std::ranges::count(facts, verdict); };
  std::string text = fmt::format(
      "{} in {}: {} reproduced, {} consistent with what was published, {} partly reproduced, "
      "{} not reproduced; the runs are too short for {}, and {} cannot be compared.",
      counted(facts.size(), "fact"), counted(judgements.size(), "claim"),
      count(Verdict::reproduced), count(Verdict::consistent), count(Verdict::partly),
      count(Verdict::not_reproduced), count(Verdict::too_short), count(Verdict::not_comparable));
  const auto surviving = std::ranges::count_if(
      judgements, [](const Judgement& judgement) { return !judgement.survives.empty(); });
  if (surviving > 0)
    text += fmt::format(" {} of the claims could not have been refuted by these runs.", surviving);
  return text;
}

Section claims_section(const std::vector<Judgement>& judgements) {
  Section section{.id = "claims",
                  .title = "Claims of the papers",
                  .otherwise = "No published claim is decided by the runs of this report."};
  if (judgements.empty()) return section;
  section.lead =
      "Measured are medians over seeds, with 95 % of the bootstrap over seeds, or the range of fewer "
      "than six. Reproduced: all of that lies within the error of what was published. Consistent: some of it does. "
      "Partly: all of it is on the published side of a tie, with a third to three times the "
      "published effect. Claims that restate one fact count once, by the weakest.";
  section.readings = {{"", claims_reading(judgements)}};
  Table table{
      .id = "claims-table",
      .columns = {"claim", "verdict", "published", "measured", "over seeds", "seeds", "remarks"},
      .align = "plrrrrp"};
  for (const Judgement& judgement : judgements) {
    table.rows.push_back(row_of(judgement));
    table.row_topics.push_back({.claim = judgement.id});
  }
  section.tables.push_back(std::move(table));
  return section;
}

Section claims_summary(const std::vector<Judgement>& judgements) {
  Section section{.id = "claims",
                  .title = "Claims of the papers",
                  .readings = {{"", claims_reading(judgements)}},
                  .otherwise = "No claim was judged."};
  std::vector<const Judgement*> order;
  for (const Judgement& judgement : judgements) order.push_back(&judgement);
  constexpr std::array<int, kVerdictNames.size()> kPlaces = {3, 2, 1, 0, 4, 5};
  std::ranges::stable_sort(order, {}, [&](const Judgement* judgement) {
    return kPlaces[static_cast<std::size_t>(judgement->verdict)];
  });
  Table table{.columns = {"claim", "verdict", "published", "measured", "seeds"}, .align = "lllll"};
  for (const Judgement* judgement : order)
    table.rows.push_back({judgement->id, marked_verdict(*judgement), judgement->published,
                          value_text(*judgement),
                          judgement->measured ? std::to_string(judgement->measured->n) : kNothing});
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace isoline::reports
