// The statistics of a report as tables and plots. Rankings use the measure of the report: work, by
// default, which is equal on every machine. Costs of runs are then in equivalent forward solves,
// with raw counts beside.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/results/ranking.h"
#include "core/results/statistics.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/quantities.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using namespace results;

using Plots = std::vector<Plot>;  // none where there is too little to show

Table profile_table(const Comparison& comparison);
Table leader_table(const Comparison& comparison);
Table choices_table(const Comparison& comparison);
Table loss_without_x_table(const Comparison& comparison);
Table condition_table(const Comparison& comparison);
Table data_profile_table(const Comparison& comparison);
Table restart_table(const Comparison& comparison);
Table calls_table(const Comparison& comparison);
Table prices_table(const Comparison& comparison);

Plots profile_plot(const Comparison& comparison);
Plots log_ratio_plot(const Comparison& comparison);
Plots data_profile_plot(const Comparison& comparison);
Plots runtime_plot(const Comparison& comparison);

// In the order of a report: what is declared above stands in it once it is named here.
inline constexpr Table (*kStatisticTables[])(const Comparison&) = {
    profile_table,      leader_table,  choices_table, loss_without_x_table, condition_table,
    data_profile_table, restart_table, calls_table,   prices_table};
inline constexpr Plots (*kStatisticPlots[])(const Comparison&) = {profile_plot, log_ratio_plot,
                                                                  data_profile_plot, runtime_plot};

// The section on rates; without rows if no method ran both ways.
Table tuned_and_defaults_table(const Comparison& comparison);

// The limits of so few problems, seeds or runs, one sentence each.
std::vector<std::string> limits_of_evidence(const Comparison& comparison);

inline constexpr std::size_t kMostTableRows = 40;  // the best optimizers
inline constexpr std::size_t kMostLines = 8;       // of a plot, the best optimizers
inline constexpr std::size_t kMostRivals = 4;      // of the leader, each in a plot of two lines

// The common part of the statistics.
// The best of the common order: of tables that compare. And of all, those apart after them.
std::size_t shown_optimizers(const Comparison& comparison, std::size_t most);
std::size_t listed_optimizers(const Comparison& comparison, std::size_t most);
void rows_are_optimizers(Table& table);  // the i-th row is of the i-th
// The first columns beside the names are of the first problems.
void columns_are_problems(Table& table, std::size_t count);
TableCell failed_cell(const Comparison& comparison, std::size_t optimizer);  // "2/80"
TableCell count_cell(std::size_t count);
TableCell share_cell(std::size_t part, std::size_t whole);  // "33 %"
// The unit of costs of single runs: measured cost if rankings use nominal cost, else the same
// measure.
Measure cost_measure(const Comparison& comparison);
std::string cost_unit(const Comparison& comparison);
std::string priced_unit(
    const Comparison& comparison);      // "equivalent forward solves at measured cost", …
Real in_units(Measure by, Real value);  // as tables and axes have it: times in ms
// "16 to 23 settings; 2 of 345 runs failed", of the first optimizers.
std::string denominators(const Comparison& comparison, std::size_t shown);
// 10^(i / 8) from 1, of times from a microsecond, to the first beyond `most`.
std::vector<Real> cost_grid(Measure by, Real most);
// The line with the greatest value above 0, with all ties.
struct Leading {
  Real value = 0;
  std::size_t count = 0;
  std::string name;

  void offer(Real mine, const std::string& label);
  std::string names() const;  // "sip † and 2 more", "nobody"
};

// The line that is highest at x: "sip † and 2 more (80 %)".
std::string highest_at(const Plot& plot, Real x);

// measure[p] of each problem: nothing where it was never asked, infinite or not-a-number where
// unsolved. The share of problems whose measure is at most each point of the grid, with the 95 %
// bootstrap band over problems, settings of one name drawn together.
using Column = std::vector<std::optional<Real>>;
Column column_of(const Costs& costs, std::size_t optimizer);
PlotSeries share_series(const Comparison& comparison, std::size_t optimizer, const Column& measure,
                        const std::vector<Real>& grid);
// The same of what `parts` makes of each measure: sums over problems over their number.
template <class Parts>
Band band_over_names(const Comparison& comparison, const Column& measure, const std::string& key,
                     Parts parts) {
  std::vector<GroupSum> groups;
  for (const auto& [name, problems] : problems_by_name(comparison)) {
    GroupSum group;
    for (const std::size_t p : problems) {
      if (!measure[p]) continue;
      const std::vector<Real> values = parts(*measure[p]);
      group.sums.resize(values.size(), 0);
      for (std::size_t i = 0; i < values.size(); ++i) group.sums[i] += values[i];
      group.n += 1;
    }
    if (group.n > 0) groups.push_back(std::move(group));
  }
  return bootstrap_ratio(groups, key);
}

// The evidence of a claim: each term of its quantity as it was read, run by run, with
// the curve it was read off.

struct EvidenceRun {
  std::string cell, file;  // the digest of what was asked; the name of the record
  std::uint64_t seed = 0;
  Real figure = 0;  // scaled
  Status status = Status::running;
};

// The alternative that counts.
struct EvidenceTerm {
  std::string problem, optimizer;         // the optimizer as the claim writes it
  std::string method;                     // the optimizer's name alone
  Real at = 1, scale = 1;                 // its abscissa, and a factor of its figures
  std::optional<std::int64_t> iteration;  // where it is read; none: at the end
  Real read_at = 0;                       // the same on the axis of its curve
  Real level = 0;                         // the median of its figures
  std::vector<EvidenceRun> runs;
  // Its figure over iterations, or over seconds: the median over seeds with the least and the
  // greatest. Empty where it is of a whole run.
  std::vector<Real> x, y, low, high;
};

struct Evidence {
  std::string kind, column;   // of the quantity
  std::string curve;          // the column of the curves
  Real published = 0;         // of a table: no distance from it
  Agreement band;             // what agrees with that
  std::string abscissa;       // the option of the problem that is each term's, where there is one
  bool is_over_time = false;  // curves are over seconds of processor time
  std::vector<EvidenceTerm> terms;
  std::vector<PrintedRow> printed;  // of an equality: the figures, and those of the first run
};

// For a claim, or for its contrast. `cells` and `iterations` are those of the set that decides it.
Evidence evidence_of(const nlohmann::json& claim, const nlohmann::json& cells, const ByCell& runs,
                     std::int64_t iterations);

// One of the lengths at which a claim can be decided.
struct CellSet {
  std::int64_t iterations = 0;
  std::size_t planned = 0, here = 0;  // cells, each once
  bool is_long = false;               // hours: run only when asked for
  bool is_deciding = false;
};
std::vector<CellSet> cell_sets(const nlohmann::json& claim, const ByCell& runs);

// The command that runs the claim again, in a folder of its own.
std::string repeat_command(const std::string& id, const std::vector<CellSet>& sets);

// Claims of papers judged by records. A claim is JSON, form isoline.claims/1, in which each set of
// cells also has what makes it findable among records: "iterations" and, for each term of the
// quantity and of its contrast, its alternatives as {"title", "cells"}: a digest a seed.

// The comparison that can refute a claim: a bound that every method satisfies says
// nothing of the one that is named.
struct Contrast {
  std::string quantity, published;
  std::optional<Measurement> measured;
  Evidence evidence;
};

// The claim read in another way that its source leaves open.
struct OtherReading {
  std::string how;  // "at equal counted work"
  Measurement measured;
  Verdict verdict = Verdict::not_comparable;
};

struct Judgement {
  std::string id, sentence, source, quantity, published, caveat;
  std::string paper, place;  // of the source: "Someone (2022)", "Figure 1"
  std::string fact;          // the claim whose fact this one restates, or itself
  Verdict verdict = Verdict::not_comparable;
  std::string why;      // it is too short, undecidable, or not comparable
  std::string reading;  // how the published figure was read off a plot, where it was
  std::optional<Measurement> measured;
  std::optional<Agreement> band;
  Evidence evidence;          // none where nothing decides it
  std::vector<CellSet> sets;  // the longest first
  std::vector<Contrast> contrasts;
  std::vector<OtherReading> others;   // the verdict is what all of them bear
  std::vector<std::string> cells;     // that decide it, of those there are
  std::vector<std::string> survives;  // nulls under which it would come out no worse, in words
  std::int64_t needs = 0;             // iterations
  Real seconds = 0;                   // that these cells took, one after the other
  bool is_drawn = false;              // its runs are of seeds, of which others could be drawn
  bool is_of_one_run = false;         // the published figure
  bool is_verification = false;       // of runs that no seed varies: an identity, or printed digits
  bool is_covered = false;            // all cells of one of its lengths are among the records
};

// In the order of the claims. The first set of cells that is complete counts: the longest.
std::vector<Judgement> judge(const nlohmann::json& claims, const std::vector<Record>& runs);

// The verdict on each fact: the weakest of the claims that restate it, of those that are decided.
// For verifications, or for all others.
std::vector<Verdict> verdicts_on_facts(const std::vector<Judgement>& judgements,
                                       bool is_verification);

}  // namespace isoline::reports
