// Finds the runs of each claim, measures what it speaks of, and compares with what was published.
#include "reports/claims.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/json.h"
#include "reports/statistics.h"
#include "reports/text.h"

namespace isoline {
namespace {

using ByCell = std::unordered_map<std::string, const Record*>;

// What was published, as the interval that agrees with it.
struct Band {
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

Band around(Real value, const Json& claim) {
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

Real published_value(const Json& published) {
  for (const char* key : {"value", "at_least", "at_most"})
    if (published.contains(key)) return real_of(published[key]);
  return 0;  // a table: no distance from it
}

Band band_of(const Json& claim) {
  const Json& published = claim.at("published");
  Band band = around(published_value(published), claim);
  if (published.contains("at_least")) band.high = kNever;
  if (published.contains("at_most")) band.low = -kNever;
  return band;
}

std::string tolerance_text(const Json& tolerance) {
  const std::string from = tolerance.at("from");
  const bool is_ratio = tolerance.value("values", 1) == 2;
  if (from == "none") return "no error stated";
  if (from == "digits")
    return fmt::format("±{} in its digits", figure(real_of(tolerance["absolute"])));
  return fmt::format("±{:.0f} % {}{}", 100 * real_of(tolerance["relative"]),
                     from == "text" ? "from text" : "off a figure", is_ratio ? ", each value" : "");
}

std::string published_text(const Json& claim) {
  const Json& published = claim.at("published");
  const std::string error = tolerance_text(claim.at("tolerance"));
  if (published.contains("table"))
    return published["table"].size() == 1
               ? fmt::format("an end point ({})", error)
               : fmt::format("{} rows of figures ({})", published["table"].size(), error);
  const char* relation = published.contains("at_least")  ? "≥ "
                         : published.contains("at_most") ? "≤ "
                                                         : "";
  return fmt::format("{}{} ({})", relation, figure(published_value(published)), error);
}

std::string source_text(const Json& source) {
  std::string text = source.at("paper");
  for (const char* part : {"section", "figure"})
    if (source.contains(part)) text += fmt::format(", {}", source[part].get<std::string>());
  return text;
}

Place place_of(const Json& claim) {
  const Json& quantity = claim.at("quantity");
  Place place{.column = quantity.at("column"), .iteration = std::nullopt, .table = {}};
  if (quantity.contains("iteration")) place.iteration = quantity["iteration"].get<std::int64_t>();
  const Json& published = claim.at("published");
  if (published.contains("table")) published["table"].get_to(place.table);
  return place;
}

std::string quantity_text(const Json& claim) {
  const Json& quantity = claim.at("quantity");
  const std::string kind = quantity.at("kind");
  const Place place = place_of(claim);
  std::vector<std::string> terms;
  for (const Json& term : quantity.at("terms")) {
    const Json& optimizer = term.at("optimizer");
    terms.push_back(optimizer.is_array() ? "best of " + std::to_string(optimizer.size())
                                         : shown_spec(optimizer.get<std::string>()));
    if (term.contains("at")) terms.back() += fmt::format(" at {}", figure(real_of(term["at"])));
  }
  return fmt::format(
      "{} of the {}, {}: {}", kind, column_words(place.column),
      place.iteration ? fmt::format("at iteration {}", *place.iteration) : "at the end",
      fmt::join(terms, kind == "ratio" ? " / " : ", "));
}

// Cells of a set that have no record, in words.
std::vector<std::string> missing_cells(const Json& set, const ByCell& runs) {
  std::vector<std::string> missing;
  for (const Json& term : set.at("terms"))
    for (const Json& alternative : term)
      for (const Json& cell : alternative.at("cells")) {
        const auto title = alternative.at("title").get<std::string>();
        const bool is_known = runs.contains(cell.get<std::string>());
        if (!is_known && std::ranges::find(missing, title) == missing.end())
          missing.push_back(title);
      }
  return missing;
}

SeedValues samples_of(const Json& set, const ByCell& runs, const Place& place) {
  SeedValues samples;
  for (const Json& term : set.at("terms")) {
    auto& alternatives = samples.emplace_back();
    for (const Json& alternative : term) {
      auto& values = alternatives.emplace_back();
      for (const Json& cell : alternative.at("cells"))
        values.push_back(figure_of(*runs.at(cell.get<std::string>()), place));
    }
  }
  return samples;
}

void measure_in(Judgement& out, const Json& claim, const Json& set, const ByCell& runs) {
  const Json& quantity = claim.at("quantity");
  const Place place = place_of(claim);
  std::vector<Real> at, scale;
  for (const Json& term : quantity.at("terms")) {
    at.push_back(term.value("at", 1.0));
    scale.push_back(term.value("scale", 1.0));
  }
  out.is_covered = true;
  for (const Json& term : set.at("terms"))
    for (const Json& alternative : term)
      for (const Json& cell : alternative.at("cells")) out.cells.push_back(cell);
  out.measured =
      measure(quantity.at("kind"), samples_of(set, runs, place), at, scale, claim.at("id"));
  if (set.contains("deviation"))
    out.caveat = set["deviation"].get<std::string>() + (out.caveat.empty() ? "" : " ") + out.caveat;
  const auto iterations = set.at("iterations").get<std::int64_t>();
  if (place.iteration && iterations < *place.iteration)
    out.why = fmt::format("too short: {} of {} iterations", iterations, *place.iteration);
  else if (std::isnan(out.measured->value))
    out.why = "the runs have no such figure";
  else if (claim.contains("not_comparable"))
    out.why = claim["not_comparable"];
  else
    out.verdict = verdict_of(out.measured->value, claim);
}

Judgement judge_one(const Json& claim, const ByCell& runs) {
  Judgement out;
  claim.at("id").get_to(out.id);
  claim.at("sentence").get_to(out.sentence);
  out.source = source_text(claim.at("source"));
  out.caveat = claim.value("caveat", "");
  out.published = published_text(claim);
  if (claim.contains("quantity")) out.quantity = quantity_text(claim);
  std::vector<std::string> missing;
  for (const Json& set : claim.value("cells", Json::array())) {
    missing = missing_cells(set, runs);
    if (missing.empty()) {
      measure_in(out, claim, set, runs);
      return out;
    }
  }
  out.why = claim.value("not_comparable", "");
  if (out.why.empty() || !missing.empty())
    out.why = fmt::format("no runs of {}", fmt::join(missing, ", "));
  return out;
}

}  // namespace

Verdict verdict_of(Real measured, const Json& claim) {
  const Band band = band_of(claim);
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

}  // namespace isoline
