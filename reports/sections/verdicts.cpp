// Finds the runs of each claim, measures what it speaks of, and compares with what was published.
#include "reports/sections/verdicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/claim_words.h"
#include "reports/sections/words.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {
namespace {

// What was published, as the interval that agrees with it.
struct Agreement {
  Real low = -kNever, high = kNever;
};

// The error of a slope whose two ends were each read with relative error t.
Real slope_error(Real t, const Json& terms) {
  Real least = kNever, most = 0;
  for (const Json& term : terms) {
    least = std::min(least, term.at("at").get<Real>());
    most = std::max(most, term.at("at").get<Real>());
  }
  return std::log((1 + t) / (1 - t)) / std::log(most / least);
}

Agreement around(Real value, const Json& claim) {
  const Json& tolerance = claim.at("tolerance");
  if (tolerance.contains("absolute")) {
    const Real error = real_of(tolerance["absolute"]);
    return {value - error, value + error};
  }
  if (!tolerance.contains("relative")) return {value, value};
  const Real t = real_of(tolerance["relative"]);
  const Json& quantity = claim.at("quantity");
  if (quantity.at("kind") == "slope") {
    const Real error = slope_error(t, quantity.at("terms"));
    return {value - error, value + error};
  }
  // A ratio of two values that were each read with error t.
  if (tolerance.value("values", 1) == 2)
    return {value * (1 - t) / (1 + t), value * (1 + t) / (1 - t)};
  return {value * (1 - t), value * (1 + t)};
}

Agreement band_of(const Json& claim) {
  const Json& published = claim.at("published");
  Agreement band = around(published_value(published), claim);
  if (published.contains("at_least")) band.high = kNever;
  if (published.contains("at_most")) band.low = -kNever;
  return band;
}

Measurement measured_in(const Json& claim, const Json& cells, const ByCell& runs,
                        const std::string& stream) {
  return measure(claim.at("quantity").at("kind"), terms_of(claim, cells, runs), stream);
}

// The weaker of what is said of the quantity and of what it is held against.
Verdict weaker_verdict(const Judgement& judged, const Json& claim) {
  const Verdict verdict = verdict_of(judged.measured->value, claim);
  if (!judged.contrast) return verdict;
  return std::max(verdict, verdict_of(judged.contrast->measured->value, claim.at("contrast")));
}

void measure_in(Judgement& out, const Json& claim, const Json& set, const ByCell& runs) {
  out.is_covered = true;
  out.cells = cells_of(set);
  out.measured = measured_in(claim, set.at("terms"), runs, out.id);
  bool is_known = !std::isnan(out.measured->value);
  if (out.contrast) {
    const Json& contrast = claim.at("contrast");
    out.contrast->measured = measured_in(contrast, set.at("contrast_terms"), runs, out.id);
    is_known = is_known && !std::isnan(out.contrast->measured->value);
  }
  if (set.contains("deviation"))
    out.caveat = set["deviation"].get<std::string>() + (out.caveat.empty() ? "" : " ") + out.caveat;
  const auto iterations = set.at("iterations").get<std::int64_t>();
  const auto asked = claim.at("quantity").value("iteration", std::int64_t{0});
  if (iterations < asked)
    out.why = fmt::format("too short: {} of {} iterations", iterations, asked);
  else if (!is_known)
    out.why = "the runs have no such figure";
  else if (claim.contains("not_comparable"))
    out.why = claim["not_comparable"];
  else
    out.verdict = weaker_verdict(out, claim);
}

Judgement judge_one(const Json& claim, const ByCell& runs) {
  Judgement out;
  claim.at("id").get_to(out.id);
  claim.at("sentence").get_to(out.sentence);
  out.source = source_text(claim.at("source"));
  out.caveat = claim.value("caveat", "");
  out.published = published_text(claim);
  if (claim.contains("quantity")) out.quantity = quantity_text(claim);
  if (claim.contains("contrast"))
    out.contrast =
        Contrast{quantity_text(claim["contrast"]), published_text(claim["contrast"]), {}};
  std::vector<std::string> missing;
  for (const Json& set : claim.value("cells", Json::array())) {
    missing = missing_cells(set, runs);
    if (missing.empty()) {
      measure_in(out, claim, set, runs);
      return out;
    }
  }
  out.why = claim.value("not_comparable", "");
  if (out.why.empty() || !missing.empty()) out.why = fmt::format("no runs of {}", joined(missing));
  return out;
}

}  // namespace

Verdict verdict_of(Real measured, const Json& claim) {
  const Agreement band = band_of(claim);
  if (measured >= band.low && measured <= band.high) return Verdict::reproduced;
  const auto neutral = neutral_of(claim.at("quantity").at("kind"));
  const Real published = published_value(claim.at("published"));
  const bool has_direction = neutral && (measured - *neutral) * (published - *neutral) > 0;
  return has_direction ? Verdict::partly : Verdict::not_reproduced;
}

std::vector<Judgement> judge(const Json& claims, const std::vector<Record>& runs) {
  ByCell by_cell;
  for (const Record& record : runs) by_cell.emplace(record.cell, &record);
  std::vector<Judgement> judgements;
  for (const Json& claim : claims) judgements.push_back(judge_one(claim, by_cell));
  return judgements;
}

}  // namespace isoline::reports
