// Finds the runs of each claim, measures what it speaks of, and compares with what was published.
#include "reports/sections/verdicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/claim_words.h"
#include "reports/sections/words.h"

namespace isoline::reports {

using Json = nlohmann::json;
namespace {

// A claim by one set of its cells.
struct Measured {
  const Json& claim;
  const Json& set;
  const ByCell& runs;
  Null null = Null::none;

  std::int64_t iterations() const { return set.at("iterations").get<std::int64_t>(); }
  Measurement of(const Json& asked, const char* list) const {
    const std::vector<Term> terms = terms_of(asked, set.at(list), runs, iterations(), null);
    return measure(asked.at("quantity").at("kind"), terms, claim.at("id"));
  }
  Evidence evidence(const Json& asked, const char* list) const {
    return evidence_of(asked, set.at(list), runs, iterations());
  }
};

// The weaker of what is said of the quantity and of what it is held against.
Verdict weaker_verdict(const Judgement& judged, const Json& claim) {
  const Verdict verdict = verdict_of(*judged.measured, claim, judged.is_drawn);
  if (!judged.contrast) return verdict;
  return std::max(verdict,
                  verdict_of(*judged.contrast->measured, claim.at("contrast"), judged.is_drawn));
}

// The measurements, of the claim and of what it is held against. Whether both are numbers.
bool take(Judgement& out, const Measured& from) {
  out.measured = from.of(from.claim, "terms");
  bool is_known = !std::isnan(out.measured->value);
  if (!out.contrast) return is_known;
  out.contrast->measured = from.of(from.claim.at("contrast"), "contrast_terms");
  return is_known && !std::isnan(out.contrast->measured->value);
}

// What else would have come to the same verdict: then the data cannot turn it.
void name_survived_nulls(Judgement& out, Measured from) {
  const auto is_survived = [&](Null null) {
    Judgement planted = out;
    from.null = null;
    return take(planted, from) && weaker_verdict(planted, from.claim) <= out.verdict;
  };
  if (is_survived(Null::untrained)) out.survives.emplace_back("networks that were never trained");
  if (has_rivals(from.claim) && is_survived(Null::twins))
    out.survives.emplace_back("one method under all its names");
}

// The length that the claim speaks of.
std::int64_t needed_iterations(const Json& claim) {
  if (claim.contains("length")) return claim["length"].at("iterations").get<std::int64_t>();
  std::int64_t needed = 0;
  const auto look = [&](const Json& from) {
    needed = std::max(needed, from.value("iteration", std::int64_t{0}));
  };
  look(claim.at("quantity"));
  for (const Json& term : claim.at("quantity").at("terms")) look(term);
  return needed;
}

void measure_in(Judgement& out, const Measured& from) {
  const Json &claim = from.claim, &set = from.set;
  out.is_covered = true;
  out.is_drawn = set.contains("seeds");
  out.cells = cells_of(set);
  const bool is_known = take(out, from);
  if (set.contains("deviation"))
    out.caveat = set["deviation"].get<std::string>() + (out.caveat.empty() ? "" : " ") + out.caveat;
  if (claim.contains("not_comparable")) {
    out.why = claim["not_comparable"];
  } else if (from.iterations() < out.needs) {
    out.verdict = Verdict::too_short;
    out.why =
        fmt::format("{} of the {} iterations that it speaks of", from.iterations(), out.needs);
  } else if (!is_known) {
    out.why = "the runs have no such figure";
  } else {
    out.verdict = weaker_verdict(out, claim);
    if (out.verdict <= Verdict::consistent) name_survived_nulls(out, from);
  }
  out.evidence = from.evidence(claim, "terms");
  if (out.contrast) out.contrast->evidence = from.evidence(claim.at("contrast"), "contrast_terms");
}

Judgement judge_one(const Json& claim, const ByCell& runs) {
  Judgement out;
  claim.at("id").get_to(out.id);
  claim.at("sentence").get_to(out.sentence);
  out.fact = claim.value("fact", out.id);
  out.source = source_text(claim.at("source"));
  out.caveat = claim.value("caveat", "");
  out.published = published_text(claim);
  if (claim.contains("quantity")) {
    out.quantity = quantity_text(claim);
    out.band = agreement_of(claim);
    out.needs = needed_iterations(claim);
  }
  if (claim.contains("contrast"))
    out.contrast =
        Contrast{quantity_text(claim["contrast"]), published_text(claim["contrast"]), {}, {}};
  out.sets = cell_sets(claim, runs);
  std::vector<std::string> missing;
  for (const Json& set : claim.value("cells", Json::array())) {
    missing = missing_cells(set, runs);
    if (missing.empty()) {
      measure_in(out, {claim, set, runs});
      return out;
    }
  }
  out.why = claim.value("not_comparable", "");
  if (out.why.empty() || !missing.empty()) out.why = fmt::format("no runs of {}", joined(missing));
  return out;
}

}  // namespace

std::vector<Judgement> judge(const Json& claims, const std::vector<Record>& runs) {
  ByCell by_cell;
  for (const Record& record : runs) by_cell.emplace(record.cell, &record);
  std::vector<Judgement> judgements;
  for (const Json& claim : claims) judgements.push_back(judge_one(claim, by_cell));
  return judgements;
}

std::vector<Verdict> verdicts_on_facts(const std::vector<Judgement>& judgements) {
  std::map<std::string, Verdict> facts;
  for (const Judgement& judgement : judgements) {
    const auto [known, is_first] = facts.emplace(judgement.fact, judgement.verdict);
    if (is_first) continue;
    Verdict& fact = known->second;
    const bool both = is_decided(fact) == is_decided(judgement.verdict);
    fact = both ? std::max(fact, judgement.verdict) : std::min(fact, judgement.verdict);
  }
  std::vector<Verdict> verdicts;
  for (const auto& [fact, verdict] : facts) verdicts.push_back(verdict);
  return verdicts;
}

}  // namespace isoline::reports
