// Contrasts named in a suite's file, tested on its nonlinear problems that are judged by x.
#include "reports/sections/contrasts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/results/contrasts.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

const std::map<std::string, std::string_view>& suites_of_tree();  // benchmarks/suites

namespace {

using Pair = std::array<std::string, 2>;  // names of methods

// Those of the suites "contest@1" that the folders were planned by.
std::vector<Pair> named_contrasts(const Study& study) {
  std::vector<Pair> all;
  for (const std::string& label : study.plan.suites) {
    const auto suite = suites_of_tree().find(label.substr(0, label.find('@')));
    if (suite == suites_of_tree().end()) continue;
    const Json json = parse_json(std::string(suite->second), suite->first);
    for (const Json& pair : json.value("contrasts", Json::array()))
      all.push_back({pair.at(0).get<std::string>(), pair.at(1).get<std::string>()});
  }
  return all;
}

std::optional<std::size_t> row_of(const Comparison& c, const std::string& method) {
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    if (c.optimizers[s].method == method && c.optimizers[s].privileges.empty()) return s;
  return std::nullopt;
}

std::vector<std::size_t> settings_of(const Comparison& c, bool is_noisy) {
  std::vector<std::size_t> all;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (is_contrasted(c.problems[p], is_noisy)) all.push_back(p);
  return all;
}

// "78/316 (in 9 of 16 families: 30–80 %)": runs of one family are no independent witnesses, so the
// bounds are of the share of families in which any fails.
TableCell failures_cell(const Comparison& c, const std::vector<std::size_t>& settings,
                        std::size_t method) {
  std::size_t runs = 0, failed = 0;
  std::map<std::string, bool> families;  // whether a run fails
  const std::size_t rung = c.yardstick.tightest().rung;
  for (const std::size_t p : settings)
    for (const std::size_t row : c.cell(p, method).runs) {
      const bool is_failed = c.runs[row].taken(Measure::work, rung) == kNever;
      ++runs;
      failed += is_failed;
      families[c.problems[p].family()] |= is_failed;
    }
  const auto with = static_cast<std::size_t>(
      std::ranges::count_if(families, [](const auto& family) { return family.second; }));
  const Interval bounds = exact_share(with, families.size());
  return {words("contrasts.failures", failed, runs, with, families.size(), percent(bounds.low),
                percent(bounds.high)),
          {{"failed", Real(failed)}, {"runs", Real(runs)}, {"families", Real(with)}}};
}

// More digits where two do not show on which side of 1 it is.
std::string factor_text(Real factor) {
  const std::string text = fmt::format("{:.2g}", factor);
  return text == "1" ? fmt::format("{:.3g}", factor) : text;
}

// The contrasts on some settings: their rows, or how many runs are missing.
struct Sequence {
  std::size_t missing = 0, families = 0;
  std::vector<std::string> absent;  // methods that were not run at all
  bool is_at_defaults = true;       // of every method on every setting
  std::vector<results::Contrast> contrasts;
  std::vector<std::string> outcomes;

  bool is_whole() const { return missing == 0 && absent.empty(); }
};

Sequence add_sequence(Table& table, const Comparison& c, const std::vector<Pair>& pairs,
                      const std::vector<std::size_t>& settings, bool is_noisy) {
  const std::string on = is_noisy ? words("contrasts.with-noise") : "";
  Sequence out;
  std::vector<std::size_t> methods;
  std::vector<std::array<std::size_t, 2>> places;  // in `methods`
  for (const Pair& pair : pairs) {
    std::array<std::size_t, 2> place{};
    for (std::size_t side : {0, 1}) {
      const auto row = row_of(c, pair[side]);
      if (!row) {
        if (std::ranges::find(out.absent, pair[side]) == out.absent.end())
          out.absent.push_back(pair[side]);
        continue;
      }
      const auto at = std::ranges::find(methods, *row);
      place[side] = static_cast<std::size_t>(at - methods.begin());
      if (at == methods.end()) methods.push_back(*row);
    }
    places.push_back(place);
  }
  for (const std::size_t p : settings)
    for (const std::size_t s : methods) {
      out.is_at_defaults = out.is_at_defaults && origin_of(c, p, s) == Origin::defaults;
      out.missing += c.cell(p, s).planned == 0 ? 1 : c.cell(p, s).missing();
    }
  if (!out.is_whole()) {
    table.rows.push_back({words("contrasts.incomplete-row") + on, "", "", "", "", "", "", ""});
    return out;
  }
  const Costs all = median_costs(c, kTightest, Measure::work);
  Costs costs;
  std::vector<std::string> families;
  for (const std::size_t p : settings) {
    costs.push_back(all[p]);
    families.push_back(c.problems[p].family());
  }
  const auto scores = family_scores(costs, families, methods);
  out.families = scores.size();
  std::vector<std::vector<Real>> differences;
  for (const auto& [first, second] : places) {
    differences.emplace_back();
    for (const std::vector<Real>& row : scores)
      differences.back().push_back(row[first] - row[second]);
  }
  constexpr std::array<const char*, 4> kOutcomes = {"contrasts.better", "contrasts.worse",
                                                    "contrasts.equal", "contrasts.undecided"};
  out.contrasts = contrasts_in_order(differences);
  const auto index = [](Real difference) {  // work of the first over that of the second
    return factor_text(std::pow(kProfileEnd, -difference));
  };
  for (std::size_t i = 0; i < out.contrasts.size(); ++i) {
    const results::Contrast& contrast = out.contrasts[i];
    out.outcomes.push_back(words(kOutcomes[static_cast<std::size_t>(contrast.outcome)], pairs[i][0],
                                 pairs[i][1], index(contrast.interval.high),
                                 index(contrast.interval.low)));
    const std::string decision = is_noisy             ? words("contrasts.estimate")
                                 : contrast.is_tested ? out.outcomes.back()
                                                      : words("contrasts.untested");
    const WorkRatio ratio =
        work_ratio(costs, families, methods[places[i][0]], methods[places[i][1]]);
    for (const std::size_t side : {0, 1})
      if (ratio.both + (side == 0 ? ratio.only_a : ratio.only_b) == 0)
        out.outcomes.back() += words("contrasts.solves-none", pairs[i][side], settings.size());
    table.rows.push_back(
        {fmt::format("{} against {}{}", pairs[i][0], pairs[i][1], on),
         {fmt::format("{:+.2f} ({:+.2f} to {:+.2f})", contrast.mean, contrast.interval.low,
                      contrast.interval.high),
          {{"difference", contrast.mean},
           {"low", contrast.interval.low},
           {"high", contrast.interval.high}}},
         {fmt::format("{:.2f}", contrast.deviation), {{"deviation", contrast.deviation}}},
         fmt::format("{} ({} to {})", index(contrast.mean), index(contrast.interval.high),
                     index(contrast.interval.low)),
         ratio.both == 0 ? "– (0)" : fmt::format("{} ({})", factor_text(ratio.median), ratio.both),
         failures_cell(c, settings, methods[places[i][0]]),
         failures_cell(c, settings, methods[places[i][1]]),
         decision});
  }
  return out;
}

// The decisions, and what so many families can find: at a usual deviation, and at that of the last
// contrast that was tested.
std::vector<std::string> sentences_of(const Sequence& sequence) {
  if (!sequence.absent.empty())
    return {words("contrasts.absent", joined(sequence.absent), sequence.absent.size())};
  if (sequence.missing > 0) return {words("contrasts.incomplete", sequence.missing)};
  std::vector<std::string> decisions;
  Real here = 0;
  for (std::size_t i = 0; i < sequence.contrasts.size(); ++i) {
    if (!sequence.contrasts[i].is_tested) continue;
    decisions.push_back(sequence.outcomes[i]);
    here = sequence.contrasts[i].deviation;
  }
  const auto found = [&](Real deviation) {
    const Real factor = detectable_factor(sequence.families, deviation);
    return factor < kNever ? words("contrasts.factor", factor) : words("contrasts.no-factor");
  };
  const std::string decided =
      words("contrasts.decided", sequence.families,
            sequence.is_at_defaults ? words("contrasts.defaults") : "", joined(decisions, "; "));
  if (!(detectable_factor(sequence.families) < kNever))
    return {decided, words("contrasts.no-power", sequence.families)};
  return {decided, words("contrasts.power", sequence.families, found(results::kUsualDeviation),
                         here, found(here))};
}

}  // namespace

bool has_contrasts(const Study& study) { return !named_contrasts(study).empty(); }

std::vector<std::string> contrast_sentences(const Comparison& c) {
  const std::vector<Pair> pairs = named_contrasts(*c.study);
  const std::vector<std::size_t> exact = settings_of(c, false);
  if (pairs.empty() || exact.empty()) return {};
  Table rows;
  return sentences_of(add_sequence(rows, c, pairs, exact, false));
}

Table contrast_table(const Comparison& c) {
  Table table = worded_table("contrasts", tau_name(c));
  const std::vector<Pair> pairs = named_contrasts(*c.study);
  const std::vector<std::size_t> exact = settings_of(c, false), noisy = settings_of(c, true);
  if (pairs.empty() || exact.empty()) return table;
  table.reading = joined(sentences_of(add_sequence(table, c, pairs, exact, false)), " ");
  if (!noisy.empty()) add_sequence(table, c, pairs, noisy, true);
  return table;
}

}  // namespace isoline::reports
