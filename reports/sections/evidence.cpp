// Collects what decides a claim, figures run by run and curves that are read as the figures are,
// and judges it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/json.h"
#include "reports/sections/claims.h"
#include "reports/sections/figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {

using Json = nlohmann::json;
namespace {

constexpr std::size_t kPoints = 24;  // a curve has up to twice as many

// The plotted part of a column: itself, its shape, or nothing if it belongs to a complete run.
std::string curve_of(const std::string& column) {
  constexpr std::array<const char*, 3> kWhole = {"milliseconds", "alignment", "turn"};
  if (column.ends_with("deviation") || std::ranges::find(kWhole, column) != kWhole.end()) return "";
  if (column.starts_with("until: ")) return bound_of(column).first;
  return column == "slowdown" ? "x_error" : column;
}

using Runs = std::vector<const Record*>;

Runs runs_of(const Json& alternative, const ByCell& runs) {
  Runs all;
  for (const Json& cell : alternative.at("cells")) all.push_back(runs.at(cell.get<std::string>()));
  return all;
}

// Kept points of a run, close at the start and close at the end, and that which is read.
std::vector<std::size_t> points_of(const Curve& curve, const Place& place) {
  std::vector<std::size_t> points = thinned(curve.iteration.size(), kPoints);
  const std::size_t stride = curve.iteration.size() / kPoints + 1;
  for (std::size_t i = 0; i < curve.iteration.size(); i += stride) points.push_back(i);
  if (place.iteration) points.push_back(index_at(curve, place));
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

// A run that has ended keeps its last figure.
void add_curve(EvidenceTerm& term, const Runs& runs, Place place, bool is_over_time) {
  const Curve& longest = (*std::ranges::max_element(runs, {}, [](const Record* run) {
                           return run->curve.iteration.size();
                         }))->curve;
  place.seconds.reset();
  for (const std::size_t i : points_of(longest, place)) {
    place.iteration = longest.iteration[i];
    std::vector<Real> values;
    for (const Record* run : runs) values.push_back(term.scale * figure_of(*run, place));
    if (std::ranges::any_of(values, [](Real value) { return std::isnan(value); })) continue;
    const auto [low, high] = std::ranges::minmax(values);
    term.x.push_back(is_over_time ? longest.processor_seconds.at(i)
                                  : static_cast<Real>(longest.iteration[i]));
    term.low.push_back(low);
    term.high.push_back(high);
    term.y.push_back(median_of(std::move(values)));
  }
}

// The option of the problems, or of the optimizers, that has the terms' abscissas as its values.
std::string abscissa_of(const std::vector<Term>& terms, const Json& cells, const ByCell& runs) {
  if (terms.size() < 2 || terms[0].at == terms[1].at) return "";
  for (const auto part : {&Request::problem, &Request::optimizer}) {
    const auto options = [&](std::size_t i) -> const OptionValues& {
      return (runs_of(cells.at(i).at(0), runs).at(0)->request.*part).options;
    };
    for (const NamedOption& option : options(0)) {
      bool is_own = true;
      for (std::size_t i = 0; i < terms.size() && is_own; ++i)
        is_own = options(i).number(option.name, kNever) == terms[i].at;
      if (is_own) return option.name;
    }
  }
  return "";
}

EvidenceTerm evidence_of_term(const Term& term, const Chosen& chosen, const Runs& all,
                              const Json& asked, const Place& place) {
  const Request& request = all.at(0)->request;
  const Json& optimizer = asked.at("optimizer");
  EvidenceTerm out{.problem = request.problem.spec,
                   .optimizer = optimizer.is_array() ? optimizer.at(chosen.alternative) : optimizer,
                   .method = request.optimizer.name,
                   .at = term.at,
                   .scale = term.scale,
                   .iteration = place.iteration,
                   .level = chosen.level};
  const std::vector<Real>& figures = term.figures.at(chosen.alternative);
  for (std::size_t seed = 0; seed < all.size(); ++seed)
    out.runs.push_back({all[seed]->cell, all[seed]->file_name(), all[seed]->request.seed,
                        term.scale * figures[seed], all[seed]->status});
  return out;
}

// For a claim, or for its contrast. `cells` and `iterations` are those of the set that decides it.
Evidence evidence_of(const Json& claim, const Json& cells, const ByCell& runs,
                     std::int64_t iterations) {
  const Json& quantity = claim.at("quantity");
  Evidence out{.kind = quantity.at("kind"),
               .column = quantity.at("column"),
               .curve = curve_of(quantity.at("column")),
               .published = published_value(claim.at("published")),
               .band = agreement_of(claim),
               .is_over_time = quantity.value("clock", "") == "seconds"};
  const std::vector<Term> terms = terms_of(claim, cells, runs, iterations);
  out.abscissa = abscissa_of(terms, cells, runs);
  const Real seconds =
      out.is_over_time ? median_of(equal_spending(cells, runs, iterations, false)) : kNever;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Json& asked = quantity.at("terms").at(i);
    Place place = place_of(claim, asked);
    const Chosen chosen = chosen_of(terms[i]);
    const Runs all = runs_of(cells.at(i).at(chosen.alternative), runs);
    EvidenceTerm& term =
        out.terms.emplace_back(evidence_of_term(terms[i], chosen, all, asked, place));
    if (i == 0 && !place.table.empty()) out.printed = printed_rows(*all.at(0), place);
    place.column = curve_of(place.column);
    if (!place.column.empty()) add_curve(term, all, place, out.is_over_time);
    if (term.x.empty()) continue;
    const Real end = term.x.back();
    term.read_at = place.iteration ? std::min(static_cast<Real>(*place.iteration), end)
                                   : std::min(seconds, end);
  }
  return out;
}

// visit(alternative) for every way to fill a term, of the claim and of its contrasts.
template <class Visit>
void each_alternative(const Json& set, Visit visit) {
  const auto visit_all = [&](const Json& terms) {
    for (const Json& term : terms)
      for (const Json& alternative : term) visit(alternative);
  };
  visit_all(set.at("terms"));
  for (const Json& terms : set.value("contrast_terms", Json::array())) visit_all(terms);
}

// Digests.
std::vector<std::string> cells_of(const Json& set) {
  std::vector<std::string> cells;
  each_alternative(set, [&](const Json& alternative) {
    for (const Json& cell : alternative.at("cells")) cells.push_back(cell);
  });
  return cells;
}

// Cells of a set that have no record, in words.
std::vector<std::string> missing_cells(const Json& set, const ByCell& runs) {
  std::vector<std::string> missing;
  each_alternative(set, [&](const Json& alternative) {
    const auto title = alternative.at("title").get<std::string>();
    const bool is_whole = std::ranges::all_of(alternative.at("cells"), [&](const Json& cell) {
      return runs.contains(cell.get<std::string>());
    });
    if (!is_whole && std::ranges::find(missing, title) == missing.end()) missing.push_back(title);
  });
  return missing;
}

std::vector<CellSet> cell_sets(const Json& claim, const ByCell& runs) {
  std::vector<CellSet> sets;
  bool is_decided = false;
  for (const Json& set : claim.value("cells", Json::array())) {
    const std::vector<std::string> all = cells_of(set);
    const std::set<std::string> cells(all.begin(), all.end());
    CellSet& out = sets.emplace_back(CellSet{.iterations = set.at("iterations"),
                                             .planned = cells.size(),
                                             .is_long = set.value("long", false)});
    out.here = static_cast<std::size_t>(
        std::ranges::count_if(cells, [&](const auto& cell) { return runs.contains(cell); }));
    out.is_deciding = !is_decided && out.here == out.planned;
    is_decided = is_decided || out.is_deciding;
  }
  return sets;
}

// A claim by one set of its cells.
struct Measured {
  const Json& claim;
  const Json& set;
  const ByCell& runs;
  Null null = Null::none;
  ReadAt at = ReadAt::asked;

  std::int64_t iterations() const { return set.at("iterations").get<std::int64_t>(); }
  Measurement of(const Json& asked, const Json& cells) const {
    const std::vector<Term> terms = terms_of(asked, cells, runs, iterations(), null, at);
    return measure(asked.at("quantity").at("kind"), terms, claim.at("id"));
  }
  Evidence evidence(const Json& asked, const Json& cells) const {
    return evidence_of(asked, cells, runs, iterations());
  }
};

// The weakest of what is said of the quantity and of what it is held against.
Verdict weakest_verdict(const Judgement& judged, const Json& claim) {
  Verdict verdict = verdict_of(*judged.measured, claim, judged.is_drawn);
  for (std::size_t i = 0; i < judged.contrasts.size(); ++i)
    verdict = std::max(verdict, verdict_of(*judged.contrasts[i].measured,
                                           claim.at("contrasts").at(i), judged.is_drawn));
  return verdict;
}

// The measurements, of the claim and of what it is held against. Whether all are numbers.
bool take(Judgement& out, const Measured& from) {
  out.measured = from.of(from.claim, from.set.at("terms"));
  bool is_known = !std::isnan(out.measured->value);
  for (std::size_t i = 0; i < out.contrasts.size(); ++i) {
    const Measurement& measured = out.contrasts[i].measured.emplace(
        from.of(from.claim.at("contrasts").at(i), from.set.at("contrast_terms").at(i)));
    is_known = is_known && !std::isnan(measured.value);
  }
  return is_known;
}

// Reads the claim in the ways that its source leaves open: its verdict must not hang on them.
void read_otherwise(Judgement& out, Measured from) {
  const auto add = [&](ReadAt at, const char* how) {
    Judgement other = out;
    from.at = at;
    if (!take(other, from)) return;
    out.others.push_back({how, *other.measured, weakest_verdict(other, from.claim)});
  };
  if (from.claim.at("quantity").contains("clock")) add(ReadAt::equal_work, "at equal counted work");
  if (from.claim.contains("length") && from.claim["length"].value("guessed", false))
    add(ReadAt::third_of_sip, "at a third of SIP’s iterations");
  for (const OtherReading& other : out.others)
    out.verdict = joint_verdict(out.verdict, other.verdict);
}

// Other sources of the same verdict: then the data cannot refute the claim.
void name_survived_nulls(Judgement& out, Measured from) {
  const auto is_survived = [&](Null null) {
    Judgement planted = out;
    from.null = null;
    return take(planted, from) && weakest_verdict(planted, from.claim) <= out.verdict;
  };
  if (is_survived(Null::untrained)) out.survives.emplace_back("untrained networks");
  if (has_rivals(from.claim) && is_survived(Null::twins))
    out.survives.emplace_back("one method under several names");
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
  out.cells = cells_of(set);
  for (const std::string& cell : std::set<std::string>(out.cells.begin(), out.cells.end()))
    out.seconds += from.runs.at(cell)->summary.wall_seconds;
  const bool is_known = take(out, from);
  if (set.contains("deviation"))
    out.caveat = set["deviation"].get<std::string>() + (out.caveat.empty() ? "" : " ") + out.caveat;
  out.evidence = from.evidence(claim, set.at("terms"));
  for (std::size_t i = 0; i < out.contrasts.size(); ++i)
    out.contrasts[i].evidence =
        from.evidence(claim.at("contrasts").at(i), set.at("contrast_terms").at(i));
  if (!out.why.empty()) return;
  if (from.iterations() < out.needs) {
    out.verdict = Verdict::too_short;
    out.why = fmt::format("{} of the {} iterations that it requires", from.iterations(), out.needs);
  } else if (!is_known) {
    out.why = "the runs have no such value";
  } else {
    out.verdict = weakest_verdict(out, claim);
    if (is_supported(out.verdict)) name_survived_nulls(out, from);
    read_otherwise(out, from);
  }
}

Judgement judge_one(const Json& claim, const ByCell& runs) {
  Judgement out;
  claim.at("id").get_to(out.id);
  claim.at("sentence").get_to(out.sentence);
  out.fact = claim.value("fact", out.id);
  out.paper = out.source = claim.at("source").at("paper");
  for (const char* part : {"section", "figure"})
    if (claim["source"].contains(part))
      out.source += ", " + claim["source"][part].get<std::string>();
  out.place = claim["source"].value("figure", claim["source"].value("section", ""));
  out.caveat = claim.value("caveat", "");
  out.published = published_text(claim);
  out.reading = reading_text(claim);
  out.is_of_one_run = claim.at("published").contains("runs");
  out.why = claim.value("undecidable", claim.value("not_comparable", ""));
  if (claim.contains("undecidable")) out.verdict = Verdict::undecidable;
  if (claim.contains("quantity")) {
    out.quantity = quantity_text(claim);
    out.band = agreement_of(claim);
    out.needs = needed_iterations(claim);
  }
  for (const Json& contrast : claim.value("contrasts", Json::array()))
    out.contrasts.push_back({quantity_text(contrast), published_text(contrast), {}, {}});
  out.sets = cell_sets(claim, runs);
  const Json sets = claim.value("cells", Json::array());
  out.is_drawn = std::ranges::any_of(sets, [](const Json& set) { return set.contains("seeds"); });
  out.is_verification = !sets.empty() && !out.is_drawn;
  std::vector<std::string> missing;
  for (const Json& set : sets) {
    missing = missing_cells(set, runs);
    if (missing.empty()) {
      measure_in(out, {claim, set, runs});
      return out;
    }
  }
  if (!missing.empty() && out.why.empty()) out.why = fmt::format("no runs of {}", joined(missing));
  return out;
}

}  // namespace

std::string repeat_command(const std::string& id, const std::vector<CellSet>& sets) {
  if (sets.empty()) return "";
  const auto deciding = std::ranges::find_if(sets, &CellSet::is_deciding);
  const bool is_long =
      deciding != sets.end() ? deciding->is_long : std::ranges::all_of(sets, &CellSet::is_long);
  return fmt::format("./isoline claims {0} --out results/{0}{1}", id, is_long ? " --long" : "");
}

std::vector<Judgement> judge(const Json& claims, const std::vector<Record>& runs) {
  ByCell by_cell;
  for (const Record& record : runs) by_cell.emplace(record.cell, &record);
  std::vector<Judgement> judgements;
  for (const Json& claim : claims) judgements.push_back(judge_one(claim, by_cell));
  return judgements;
}

std::vector<Verdict> verdicts_on_facts(const std::vector<Judgement>& judgements,
                                       bool is_verification) {
  std::map<std::string, Verdict> facts;
  for (const Judgement& judgement : judgements) {
    if (judgement.is_verification != is_verification) continue;
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
