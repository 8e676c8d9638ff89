// Collects what decides a claim: figures run by run, and curves that are read as the figures are.
#include "reports/sections/claim_evidence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "reports/read/curves.h"
#include "reports/sections/claim_words.h"

namespace isoline::reports {

using Json = nlohmann::json;
namespace {

constexpr std::size_t kPoints = 24;  // a curve has up to twice as many

// What is drawn of a column: itself, what it is the shape of, or nothing where it is of a whole
// run.
std::string curve_of(const std::string& column) {
  constexpr std::array<const char*, 3> kWhole = {"milliseconds", "alignment", "turn"};
  if (column.ends_with("deviation") || std::ranges::find(kWhole, column) != kWhole.end()) return "";
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

}  // namespace

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
      out.is_over_time ? median_of(equal_seconds(cells, runs, iterations)) : kNever;
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

std::string repeat_command(const std::string& id, const std::vector<CellSet>& sets) {
  if (sets.empty()) return "";
  const auto deciding = std::ranges::find_if(sets, &CellSet::is_deciding);
  const bool is_long =
      deciding != sets.end() ? deciding->is_long : std::ranges::all_of(sets, &CellSet::is_long);
  return fmt::format("./isoline claims {0} --out results/{0}{1}", id, is_long ? " --long" : "");
}

}  // namespace isoline::reports
