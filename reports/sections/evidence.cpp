// Collects the evidence for a claim, which consists of values per run and curves read in the same
// way, and judges the claim.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <unordered_map>

#include "core/json.h"
#include "core/text.h"
#include "reports/sections/claims.h"
#include "reports/sections/figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {

using Json = nlohmann::json;
namespace {

using ByCell = std::unordered_map<std::string, const Record*>;

// Where a term of a claim, or of its contrast, is read.
Place place_of(const Json& claim, const Json& term) {
  const Json& quantity = claim.at("quantity");
  Place place;
  (term.contains("column") ? term : quantity).at("column").get_to(place.column);
  const Json& from = term.contains("iteration") ? term : quantity;
  if (from.contains("iteration")) place.iteration = from["iteration"].get<std::int64_t>();
  const Json& published = claim.at("published");
  if (published.contains("table")) published["table"].get_to(place.table);
  return place;
}

using Runs = std::vector<const Record*>;

Runs runs_of(const Json& alternative, const ByCell& runs) {
  Runs all;
  for (const Json& cell : alternative.at("cells")) all.push_back(runs.at(cell.get<std::string>()));
  return all;
}

// The processor time of each seed, or its counted work, at which the cheapest run of it has made so
// many iterations: a run is charged at its own price, also where it stopped before.
std::vector<Real> equal_spending(const Json& cells, const ByCell& runs, std::int64_t iterations,
                                 bool is_work) {
  std::vector<Real> spent;
  for (const Json& term : cells)
    for (const Json& alternative : term) {
      const Runs all = runs_of(alternative, runs);
      spent.resize(std::max(spent.size(), all.size()), kNever);
      for (std::size_t seed = 0; seed < all.size(); ++seed) {
        const Summary& summary = all[seed]->summary;
        if (summary.iterations == 0) continue;
        const Real whole = is_work ? static_cast<Real>(summary.work) : summary.processor_seconds;
        spent[seed] = std::min(spent[seed], whole / static_cast<Real>(summary.iterations) *
                                                static_cast<Real>(iterations));
      }
    }
  return spent;
}

// How the figures of a claim are read.
enum class Way {
  asked,
  // The comparisons that must refute a claim, besides permuted names of optimizers.
  untrained,  // nothing was learned: each figure is that of iteration 0
  twins,      // one method under several names: all terms of a problem are the same run
  // The verdict must not hang on these: a time is that of a machine, and the published runs of the
  // sine had a time, in which SIP made a third of the iterations of others.
  equal_work,
  third_of_sip
};

// The figures of a claim's terms, or of a contrast's. `cells` is a list of terms, each a list of
// alternatives. Where the claim asks for equal time, all are read at the time at which the fastest
// has made `iterations`.
std::vector<Term> terms_of(const Json& claim, const Json& cells, const ByCell& runs,
                           std::int64_t iterations, Way way = Way::asked) {
  constexpr std::int64_t kThird = 3;
  const Json &quantity = claim.at("quantity"), &asked = quantity.at("terms");
  const bool is_work = way == Way::equal_work;
  std::vector<Real> spent;
  if (quantity.value("clock", "") == "seconds")
    spent = equal_spending(cells, runs, iterations, is_work);
  std::vector<Term> terms;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    Term& term = terms.emplace_back(Term{.figures = {},
                                         .at = asked.at(i).value("at", 1.0),
                                         .scale = asked[i].value("scale", 1.0),
                                         .is_worst = asked[i].value("of", "best") == "worst"});
    for (const Json& alternative : cells[i]) {
      auto& values = term.figures.emplace_back();
      for (const Record* run : runs_of(alternative, runs)) {
        Place place = place_of(claim, asked[i]);
        const bool is_third = way == Way::third_of_sip && run->request.optimizer.name == "sip";
        if (way == Way::untrained) place.iteration = 0;
        if (is_third && !place.iteration) place.iteration = iterations / kThird;
        if (!spent.empty() && !place.iteration && is_work)
          place.work = std::llround(spent.at(values.size()));
        if (!spent.empty() && !place.iteration && !is_work) place.seconds = spent.at(values.size());
        values.push_back(figure_of(*run, place));
      }
    }
    // A twin takes the figures of the first term of its problem that is read at its iteration.
    const auto is_same = [&](const Term& other) {
      const Json& its = asked[static_cast<std::size_t>(&other - terms.data())];
      return std::ranges::all_of(
          std::array{"problem", "iteration", "column"},
          [&](const char* key) { return asked[i].value(key, Json()) == its.value(key, Json()); });
    };
    if (way == Way::twins) term.figures = std::ranges::find_if(terms, is_same)->figures;
  }
  return terms;
}

std::string tolerance_text(const Json& tolerance) {
  const std::string from = tolerance.at("from");
  if (from == "none" || from == "order") return words("tolerance." + from);
  if (tolerance.contains("absolute"))
    return words("tolerance." + from, real_of(tolerance["absolute"]));
  const Real t = real_of(tolerance["relative"]);
  const std::string text = words("tolerance." + from, 100 * t);
  if (from == "about" || tolerance.value("values", 1) != 2) return text;
  // The band of quantities.cpp for a ratio of two readings.
  return words("tolerance.two", text, 100 * ((1 - t) / (1 + t) - 1), 100 * ((1 + t) / (1 - t) - 1));
}

std::string iteration_text(const Json& from, const char* otherwise) {
  if (!from.contains("iteration")) return otherwise;
  return fmt::format("at iteration {}", from["iteration"].get<std::int64_t>());
}

std::string term_text(const Json& term) {
  const Json& optimizer = term.at("optimizer");
  std::string text = optimizer.is_array()
                         ? fmt::format("{} of {}", term.value("of", "best"), optimizer.size())
                         : shown_spec(optimizer.get<std::string>());
  if (term.contains("column")) text += " (" + column_words(term["column"]) + ")";
  if (term.contains("iteration")) text += " " + iteration_text(term, "");
  if (term.contains("at")) text += fmt::format(" at {}", figure(real_of(term["at"])));
  return text;
}

// "≥ 3 (±5 % from text)"
std::string published_text(const Json& claim) {
  const Json& published = claim.at("published");
  const std::string error = tolerance_text(claim.at("tolerance"));
  if (published.contains("table"))
    return published["table"].size() == 1
               ? fmt::format("an end point ({})", error)
               : fmt::format("{} rows of numbers ({})", published["table"].size(), error);
  const char* relation = published.contains("at_least")  ? "≥ "
                         : published.contains("at_most") ? "≤ "
                                                         : "";
  return fmt::format("{}{} ({})", relation, figure(published_value(published)), error);
}

// How it was read off a figure, else empty.
std::string reading_text(const Json& claim) {
  const std::string from = claim.at("tolerance").at("from");
  if (from != "figure" && from != "digitized") return "";
  const Json& source = claim.at("source");
  return words("reading." + from, source.value("figure", source.value("section", "a figure")));
}

// "loss: the value of adam divided by that of sip, at the end"
std::string quantity_text(const Json& claim) {
  const Json& quantity = claim.at("quantity");
  const std::string kind = quantity.at("kind");
  std::vector<std::string> terms;
  for (const Json& term : quantity.at("terms")) terms.push_back(term_text(term));
  if (std::set(terms.begin(), terms.end()).size() < terms.size())  // the problem tells them apart
    for (std::size_t i = 0; i < terms.size(); ++i)
      if (const Json& term = quantity["terms"][i]; term.contains("problem"))
        terms[i] += " on " + shown_spec(term["problem"].get<std::string>());
  const std::string column = column_words(quantity.at("column")),
                    when = iteration_text(quantity, quantity.contains("clock")
                                                        ? "at equal processor time"
                                                        : "at the end");
  if (kind == "ratio") return words("quantity.ratio", column, when, terms.at(0), terms.at(1));
  return words("quantity.other", column, when, kind == "mean_difference" ? "mean difference" : kind,
               joined(terms));
}

constexpr std::size_t kPoints = 24;  // a curve has up to twice as many

// The plotted part of a column: itself, its shape, or nothing if it belongs to a complete run.
std::string curve_of(const std::string& column) {
  constexpr std::array<const char*, 4> kWhole = {"milliseconds", "peak_memory", "alignment",
                                                 "turn"};
  if (column.ends_with("deviation") || std::ranges::find(kWhole, column) != kWhole.end()) return "";
  if (is_level(column)) return bound_of(column).first;
  return column == "slowdown" ? "x_error" : column;
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
    const Json &asked = quantity.at("terms").at(i), &optimizer = asked.at("optimizer");
    Place place = place_of(claim, asked);
    const auto [alternative, level] = chosen_of(terms[i]);
    const Runs all = runs_of(cells.at(i).at(alternative), runs);
    const Request& request = all.at(0)->request;
    EvidenceTerm& term = out.terms.emplace_back(
        EvidenceTerm{.problem = request.problem.spec,
                     .optimizer = optimizer.is_array() ? optimizer.at(alternative) : optimizer,
                     .method = request.optimizer.name,
                     .at = terms[i].at,
                     .scale = terms[i].scale,
                     .iteration = place.iteration,
                     .level = level});
    for (std::size_t seed = 0; seed < all.size(); ++seed)
      term.runs.push_back({all[seed]->cell, all[seed]->file_name(), all[seed]->request.seed,
                           term.scale * terms[i].figures.at(alternative)[seed], all[seed]->status});
    if (i == 0 && !place.table.empty()) out.printed = printed_rows(*all.at(0), place);
    place.column = curve_of(place.column);
    if (!place.column.empty()) add_curve(term, all, place, out.is_over_time);
    if (term.x.empty()) continue;
    term.read_at =
        std::min(place.iteration ? static_cast<Real>(*place.iteration) : seconds, term.x.back());
  }
  return out;
}

// Every way to fill a term, of the claim and of its contrasts.
std::vector<Json> alternatives_of(const Json& set) {
  std::vector<Json> all, lists = {set.at("terms")};
  for (const Json& terms : set.value("contrast_terms", Json::array())) lists.push_back(terms);
  for (const Json& terms : lists)
    for (const Json& term : terms) all.insert(all.end(), term.begin(), term.end());
  return all;
}

// Digests.
std::vector<std::string> cells_of(const Json& set) {
  std::vector<std::string> cells;
  for (const Json& alternative : alternatives_of(set))
    for (const Json& cell : alternative.at("cells")) cells.push_back(cell);
  return cells;
}

// Cells of a set that have no record, in words.
std::vector<std::string> missing_cells(const Json& set, const ByCell& runs) {
  std::vector<std::string> missing;
  for (const Json& alternative : alternatives_of(set)) {
    const auto title = alternative.at("title").get<std::string>();
    const bool is_whole = std::ranges::all_of(alternative.at("cells"), [&](const Json& cell) {
      return runs.contains(cell.get<std::string>());
    });
    if (!is_whole && std::ranges::find(missing, title) == missing.end()) missing.push_back(title);
  }
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
  Way way = Way::asked;

  std::int64_t iterations() const { return set.at("iterations").get<std::int64_t>(); }
  Measurement of(const Json& asked, const Json& cells) const {
    return measure(asked.at("quantity").at("kind"), terms_of(asked, cells, runs, iterations(), way),
                   claim.at("id"));
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
  const auto add = [&](Way way, const char* how) {
    Judgement other = out;
    from.way = way;
    if (!take(other, from)) return;
    out.others.push_back({how, *other.measured, weakest_verdict(other, from.claim)});
  };
  if (from.claim.at("quantity").contains("clock")) add(Way::equal_work, "at equal counted work");
  if (from.claim.contains("length") && from.claim["length"].value("guessed", false))
    add(Way::third_of_sip, "at a third of SIP’s iterations");
  const Verdict alone = out.verdict;
  for (const OtherReading& other : out.others)
    out.verdict = joint_verdict(out.verdict, other.verdict);
  if (out.verdict != alone) out.alone = alone;
}

// Other sources of the same verdict: then the data cannot refute the claim.
void name_survived_nulls(Judgement& out, Measured from) {
  const auto try_way = [&](Way way, const char* name) {
    Judgement planted = out;
    from.way = way;
    if (take(planted, from) && weakest_verdict(planted, from.claim) <= out.verdict)
      out.survives.emplace_back(name);
  };
  try_way(Way::untrained, "untrained networks");
  if (has_rivals(from.claim)) try_way(Way::twins, "one method under several names");
}

// The length that the claim speaks of.
std::int64_t needed_iterations(const Json& claim) {
  if (claim.contains("length") && claim["length"].contains("iterations"))
    return claim["length"]["iterations"].get<std::int64_t>();
  const Json& quantity = claim.at("quantity");
  std::int64_t needed = quantity.value("iteration", std::int64_t{0});
  for (const Json& term : quantity.at("terms"))
    needed = std::max(needed, term.value("iteration", std::int64_t{0}));
  return needed;
}

// How the runs of a shorter set vary, where this one has a single run of each term.
void borrow_spread(Judgement& out, const Measured& from) {
  if (out.measured->n != 1) return;
  for (const Json& set : from.claim.at("cells")) {
    if (!set.contains("seeds") || set.at("iterations") >= from.iterations() ||
        set.at("terms").at(0).at(0).at("cells").size() < kFewestForInterval ||
        !missing_cells(set, from.runs).empty())
      continue;
    Judgement shorter = out;
    take(shorter, {from.claim, set, from.runs});
    const auto lend = [](Measurement& to, const Measurement& of, const Json& claim) {
      const std::optional<Real> deviation = deviation_of_runs(of, claim);
      if (!deviation) return;
      to.shorter_runs = of.each.size();
      to.deviation_of_shorter = *deviation;
    };
    lend(*out.measured, *shorter.measured, from.claim);
    for (std::size_t i = 0; i < out.contrasts.size(); ++i)
      lend(*out.contrasts[i].measured, *shorter.contrasts[i].measured,
           from.claim.at("contrasts").at(i));
    if (out.measured->shorter_runs > 0)
      out.caveats.insert(
          out.caveats.begin(),
          words("claim.shorter-runs", out.measured->shorter_runs,
                set.at("iterations").get<std::int64_t>(), out.measured->shorter_runs - 1));
    return;
  }
}

// The run of that digest, which published ones and those with a limit of time are not kept by.
const Record& record_of(const Measured& from, const std::string& cell) {
  const std::vector<std::string> keys = cells_of(from.set);
  return *from.runs.at(*std::ranges::find(
      keys, cell, [&](const std::string& key) { return from.runs.at(key)->cell; }));
}

// A comparison by the clock: the first method has the loss of the second's end after so many
// more of its iterations, so the second is the quicker one where its step costs less than that.
// This does not depend on the speed of an implementation.
std::string break_even_text(const Judgement& judged, const Measured& from) {
  const Json& quantity = from.claim.at("quantity");
  if (quantity.value("clock", "") != "seconds" || quantity.at("kind") != "ratio") return "";
  const auto& terms = judged.evidence.terms;
  std::vector<Real> ratios;
  bool is_reached = true;
  for (std::size_t seed = 0; seed < terms.at(0).runs.size(); ++seed) {
    const Record &first = record_of(from, terms[0].runs[seed].cell),
                 &second = record_of(from, terms.at(1).runs.at(seed).cell);
    const auto steps = static_cast<Real>(second.summary.iterations);
    const Real end = figure_of(second, {.column = quantity.at("column")});
    Real needed = static_cast<Real>(first.summary.iterations);
    bool is_there = false;
    for (const std::int64_t iteration : first.curve.iteration) {
      const Place place{.column = quantity.at("column"), .iteration = iteration};
      is_there = figure_of(first, place) <= end;
      if (!is_there) continue;
      needed = static_cast<Real>(iteration);
      break;
    }
    is_reached = is_reached && is_there;
    if (steps > 0) ratios.push_back(needed / steps);
  }
  if (ratios.empty()) return "";
  const std::string steps = fmt::format("{:.2g}", median_of(std::move(ratios)));
  return words(is_reached ? "claim.break-even" : "claim.break-even-at-least", terms[1].method,
               terms[0].method, steps == "1" ? "" : steps + " × ");
}

// Why runs are too short to decide a claim; empty where they are not. `length` may state what was
// published beyond the place that is read: below a tenth of it nothing is decided.
std::string shortness_text(const Judgement& judged, const Measured& from) {
  constexpr std::int64_t kTenth = 10;
  if (from.iterations() < judged.needs)
    return fmt::format("{} of the {} required iterations", from.iterations(), judged.needs);
  if (from.set.contains("stands_in")) return from.set["stands_in"];
  const Json length = from.claim.value("length", Json::object());
  const std::int64_t published = length.value("published", std::int64_t{0});
  if (kTenth * from.iterations() < published)
    return words("claim.tenth-of-iterations", from.iterations(), published);
  const Real seconds = length.value("published_seconds", 0.0);
  Real longest = 0;
  for (const std::string& cell : judged.cells)
    longest = std::max(longest, from.runs.at(cell)->summary.processor_seconds);
  return static_cast<Real>(kTenth) * longest < seconds
             ? words("claim.tenth-of-seconds", longest, seconds)
             : "";
}

void measure_in(Judgement& out, const Measured& from) {
  const Json &claim = from.claim, &set = from.set;
  out.is_covered = true;
  out.cells = cells_of(set);
  for (const std::string& cell : std::set<std::string>(out.cells.begin(), out.cells.end()))
    out.seconds += from.runs.at(cell)->summary.processor_seconds;
  const bool is_known = take(out, from);
  out.deviation = set.value("deviation", "");
  for (const char* difference : {"deviation", "builds"})
    if (set.contains(difference)) out.caveats.insert(out.caveats.begin(), set[difference]);
  out.reached = set.value("reached", "");
  out.evidence = evidence_of(claim, set.at("terms"), from.runs, from.iterations());
  for (std::size_t i = 0; i < out.contrasts.size(); ++i)
    out.contrasts[i].evidence = evidence_of(
        claim.at("contrasts").at(i), set.at("contrast_terms").at(i), from.runs, from.iterations());
  out.direction = direction_of(*out.measured, claim);
  out.break_even = break_even_text(out, from);
  if (!out.why.empty()) return;
  if (out.why = shortness_text(out, from); !out.why.empty()) {
    out.verdict = Verdict::too_short;
  } else if (!is_known) {
    out.why = "the runs do not have this value";
  } else {
    if (out.is_drawn) borrow_spread(out, from);
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
  if (claim.contains("caveat")) out.caveats = {claim["caveat"]};
  out.published = published_text(claim);
  out.reading = reading_text(claim);
  out.is_of_one_run = claim.at("published").value("runs", 0) == 1;
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
  if (!missing.empty() && out.why.empty())
    out.why = fmt::format("missing runs: {}", joined(missing));
  return out;
}

}  // namespace

bool has_rivals(const Json& claim) {
  const Json& terms = claim.at("quantity").at("terms");
  for (const Json& one : terms)
    for (const Json& other : terms)
      if (one.value("problem", "") == other.value("problem", "") &&
          one.at("optimizer") != other.at("optimizer"))
        return true;
  const Json contrasts = claim.value("contrasts", Json::array());
  return std::ranges::any_of(contrasts, has_rivals);
}

bool takes_hours(const std::vector<CellSet>& sets) {
  const auto deciding = std::ranges::find_if(sets, &CellSet::is_deciding);
  return deciding != sets.end() ? deciding->is_long
                                : !sets.empty() && std::ranges::all_of(sets, &CellSet::is_long);
}

std::string repeat_command(const std::string& id, const std::vector<CellSet>& sets) {
  if (sets.empty()) return "";
  return fmt::format("./isoline claims {0} --out results/{0}{1}", id,
                     takes_hours(sets) ? " --long" : "");
}

namespace {

// Published records as the beginnings of what claims ask for: the longest by the digest that its
// cell has at each length. Their keys are their own, so that runs of a folder come before them.
using Beginnings = std::map<std::string, const Record*>;
std::string published_key(const Record& record) { return "published " + record.cell; }

std::int64_t reached_iterations(const Record& record) {
  return record.is_nondeterministic ? record.summary.iterations : record.request.budget.iterations;
}

Beginnings beginnings_of(const Json& claims, const std::vector<Record>& published) {
  std::set<std::int64_t> lengths;
  for (const Json& claim : claims)
    for (const Json& set : claim.value("cells", Json::array()))
      lengths.insert(set.at("iterations").get<std::int64_t>());
  Beginnings all;
  for (const Record& record : published)
    for (const std::int64_t length : lengths) {
      if (length < reached_iterations(record) || is_failure(record.status)) continue;
      Request asked = record.request;
      asked.budget.iterations = length;
      asked.budget.seconds = Budget{}.seconds;
      const Record*& longest = all[cell_digest(asked)];
      if (!longest || reached_iterations(*longest) < reached_iterations(record)) longest = &record;
    }
  return all;
}

// The part of a set of cells that published records have: the seeds that all its terms have, with
// the iterations that all have made; a record of fewer than `least` counts as none. Nothing if
// there are none.
std::optional<Json> published_part(const Json& set, const Beginnings& beginnings,
                                   std::int64_t least) {
  Json part = set;
  std::vector<Json*> lists;  // of digests, by seed
  const auto add = [&](Json& terms) {
    for (Json& term : terms)
      for (Json& alternative : term) lists.push_back(&alternative.at("cells"));
  };
  add(part.at("terms"));
  if (part.contains("contrast_terms"))
    for (Json& terms : part["contrast_terms"]) add(terms);
  const std::size_t seeds = lists.at(0)->size();
  std::int64_t iterations = set.at("iterations");
  std::set<std::string> builds;
  std::vector<Json> kept(lists.size(), Json::array());
  for (std::size_t seed = 0; seed < seeds; ++seed) {
    std::vector<const Record*> records;
    for (const Json* list : lists) {
      const auto found = beginnings.find(list->at(seed).get<std::string>());
      if (found != beginnings.end() && reached_iterations(*found->second) >= least)
        records.push_back(found->second);
    }
    if (records.size() < lists.size()) continue;
    for (std::size_t i = 0; i < lists.size(); ++i) {
      kept[i].push_back(published_key(*records[i]));
      iterations = std::min(iterations, reached_iterations(*records[i]));
      builds.insert(
          fmt::format("{} (commit {})", records[i]->build, records[i]->provenance.build->commit));
    }
  }
  if (kept.at(0).empty()) return std::nullopt;
  for (std::size_t i = 0; i < lists.size(); ++i) *lists[i] = kept[i];
  part["iterations"] = iterations;
  part["reached"] =
      words("claim.published-part", isoline::count_text(std::uint64_t(iterations)),
            isoline::count_text(set.at("iterations").get<std::uint64_t>()), kept[0].size(), seeds);
  part["builds"] =
      words("claim.published-builds", joined({builds.begin(), builds.end()}), builds.size());
  return part;
}

// Each part comes after its whole, and before sets that have no more seeds, if it is long enough.
Json with_published(Json claim, const Beginnings& beginnings) {
  if (!claim.contains("cells")) return claim;
  const auto seeds_of = [](const Json& set) {
    return set.at("terms").at(0).at(0).at("cells").size();
  };
  Json sets = claim["cells"];
  for (const Json& set : claim["cells"]) {
    std::optional<Json> part = published_part(set, beginnings, needed_iterations(claim));
    if (!part) {  // all are too short, which the verdict says: the longest
      std::int64_t least = 0;
      while (std::optional<Json> longer = published_part(set, beginnings, least)) {
        least = longer->at("iterations").get<std::int64_t>() + 1;
        part = std::move(longer);
      }
    }
    if (!part) continue;
    auto at = std::ranges::find(sets, set) + 1;
    const bool is_long_enough = part->at("iterations") >= needed_iterations(claim);
    while (at != sets.end() && (!is_long_enough || seeds_of(*part) < seeds_of(*at))) ++at;
    sets.insert(at, *part);
  }
  claim["cells"] = std::move(sets);
  return claim;
}

}  // namespace

std::vector<Judgement> judge(const Json& claims, const std::vector<Record>& runs,
                             const std::vector<Record>& published) {
  ByCell by_cell;
  // An inapplicable run has no values.
  const auto is_empty = [](const Record& record) { return record.curve.iteration.empty(); };
  for (const Record& record : runs)
    if (!is_empty(record)) by_cell.emplace(record.cell, &record);
  // A limit of time that did not end a run has not changed what it computed.
  for (const Record& record : runs) {
    Request asked = record.request;
    if (record.is_nondeterministic || asked.budget.seconds == Budget{}.seconds || is_empty(record))
      continue;
    asked.budget.seconds = Budget{}.seconds;
    by_cell.emplace(cell_digest(asked), &record);
  }
  for (const Record& record : published) by_cell.emplace(published_key(record), &record);
  const Beginnings beginnings = beginnings_of(claims, published);
  std::vector<Judgement> judgements;
  for (const Json& claim : claims)
    judgements.push_back(judge_one(with_published(claim, beginnings), by_cell));
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
