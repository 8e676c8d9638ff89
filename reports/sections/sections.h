// The sections of a report, one file a topic; overview.cpp puts them in order.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/records/sheet.h"
#include "core/results/advice.h"
#include "core/results/ranking.h"
#include "core/results/statistics.h"
#include "core/results/uncertainty.h"
#include "reports/sections/claims.h"
#include "reports/sections/figures.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using namespace results;

using Audits = std::vector<AuditedOptimizer>;
using Plots = std::vector<Plot>;  // none where there is too little to show

Section fit_section(const Comparison& comparison);  // of a user's own problems; empty without one
Section standings_section(const Comparison& comparison);
Section problems_section(const Comparison& comparison);  // a sentence each, and the matrix
Section learned_section(const Comparison& comparison, const std::vector<Judgement>& claims = {});
// Whether a claim is on the ratio of two errors in x.
bool is_error_ratio(const Judgement& claim);
// Those of learned problems, by the problem and by the methods whose error is under and over.
using RatioClaims = std::map<std::array<std::size_t, 3>, std::vector<const Judgement*>>;
RatioClaims ratio_claims(const Comparison& comparison, const std::vector<Judgement>& claims);
// The work of an iteration in forward solves, and its milliseconds; medians over the runs.
std::array<Real, 2> step_costs(const Comparison& comparison, const Cell& cell);
Section amortized_section(const Comparison& comparison);  // training once, or solving each
Section sweeps_section(const Comparison& comparison);     // two options at a time, as heat maps
Section spectra_section(const Comparison& comparison);    // of J, where runs kept them
Section properties_section(const Audits& audits);
// A text on a column: what is "measured", its "rule", the "reason" why it may not hold, and the
// "advice" then.
std::string conduct_text(const std::string& column, const char* part);
Section conduct_section(const Audits& audits);  // counts, statuses, points and bounds, as measured
Section tuning_section(const Comparison& comparison);  // the origin of rates, and their gain
Section statistics_section(const Comparison& comparison);
Section failures_section(const Comparison& comparison);
Section builds_section(const Comparison& comparison);

// A report before it has a format: its sections in order, and what they were made from.
struct Document {
  Comparison comparison;  // of a study that must outlive it
  std::vector<Judgement> claims;
  std::string out = {};    // the folder that it goes to, where that is known: links start there
  std::string headline;    // "33 optimizers on 16 problems, …"
  std::string statuses;    // "target 3, budget 2"
  std::string incomplete;  // which cells are missing; empty where none is
  std::vector<std::string> remarks;  // what a reader must know before believing the tables
  std::vector<Section> sections;
  std::vector<Figure> figures;

  const Section& section(std::string_view id) const;
};
// Claims are those whose cells are among the runs.
Document document_of(Comparison comparison, std::vector<Judgement> claims = {});

// Sentences of them that others say too.
std::string headline(const Comparison& comparison);
std::string version_text(const Comparison& comparison);  // "Isoline 0.1.0 (1a2b3c4)"
std::string missing_text(const Comparison& comparison);
std::vector<std::string> remarks(const Comparison& comparison);
std::string unchecked_text(const Comparison& comparison);  // which problems ran without checks
std::vector<std::string> verdict(const Comparison& comparison);          // what the decision says
std::vector<std::string> first_sentences(const Comparison& comparison);  // few and short
std::vector<Reading> ranking_facts(const Comparison& comparison);  // the group, how robust, not run
// Which settings the ranking leaves out, and why; empty where it leaves out none.
std::string left_out_text(const Comparison& comparison);
// A method that is not ranked, among the ranked ones on the common settings that it was run on,
// best first; empty for others.
std::vector<Ranked> standings_beside(const Comparison& comparison, std::size_t optimizer);
// Which methods were run on some of the common settings only; empty where none was.
std::string unranked_sentence(const Comparison& comparison);
std::vector<std::string> learned_sentences(const Comparison& comparison);  // at equal work
std::string profile_reading(const Comparison& comparison, std::size_t tolerance);
std::string curve_reading(const Comparison& comparison, std::size_t problem);
std::string choice_text(const Choice& choice);  // "to accuracy 1e-3", "without heat"
// How many methods have rates of tables; empty where no run used one.
std::string rates_text(const Comparison& comparison);
// A summary of an audit, one sentence per property; the last on false declarations.
std::vector<Reading> property_readings(const Audits& all);
// The limits of so few problems, seeds or runs, one sentence each.
std::vector<std::string> limits_of_evidence(const Comparison& comparison);

// Sentences on a reader's means, and on the advice for them.
std::string means_text(const Means& means);
// With the options that it was run with, where these are the same everywhere.
std::string advised_name(const Comparison& comparison, const Advised& one);
std::string advice_text(const Comparison& comparison, const Means& means, const Advice& advice);

// The statistics. A new one is a function here, in one of the two lists of statistics.cpp.
Table profile_table(const Comparison& comparison);
Table leader_table(const Comparison& comparison);
Table choices_table(const Comparison& comparison);
Table variation_table(const Comparison& comparison);  // empty where no instances and starts cross
Table loss_without_x_table(const Comparison& comparison);
// Sections on settings with noise, bounds or other features; empty where there are none.
Table features_table(const Comparison& comparison);
Table discrepancy_table(const Comparison& comparison);
Plots noise_plot(const Comparison& comparison);
Table l_curve_table(const Comparison& comparison);  // empty where no settings differ in tikhonov
Plots l_curve_plot(const Comparison& comparison);
// Work over the number of unknowns; empty where no settings differ in their size alone.
Table size_table(const Comparison& comparison);
Plots size_plots(const Comparison& comparison);
Table fixed_budget_table(const Comparison& comparison);  // empty where no x* is known
Table data_profile_table(const Comparison& comparison);
Table simplex_profile_table(const Comparison& comparison);  // of Moré and Wild
Table restart_table(const Comparison& comparison);
Table calls_table(const Comparison& comparison);
// Methods whose work is forward solves only; empty where none of them shares rounds.
Table rounds_table(const Comparison& comparison);
Table prices_table(const Comparison& comparison);
Table certified_table(const Comparison& comparison);  // empty where no run is of NIST's regressions
// Standard deviations of x, a table per problem, by the best run that keeps them.
std::vector<Table> uncertainty_tables(const Comparison& comparison);
Plots profile_plot(const Comparison& comparison);
Plots data_profile_plot(const Comparison& comparison);
Plots runtime_plot(const Comparison& comparison);

// The options of a setting; nullptr where it has no run.
const OptionValues* options_of(const Comparison& comparison, std::size_t problem);
// The common parts of their tables.
inline constexpr Real kNoiseFactor =
    1.1;  // τ of the discrepancy principle, unless a run has its own
inline constexpr std::size_t kMostTableRows = 40;  // the best optimizers
inline constexpr std::size_t kMostLines = 8;       // of a plot, the best optimizers
// Adds a row of the optimizer, which it names in its first cell and by topic.
void add_row(Table& table, const Comparison& comparison, std::size_t optimizer,
             std::vector<TableCell> cells);
TableCell failed_cell(const Comparison& comparison, std::size_t optimizer);  // "2/80"
TableCell count_cell(std::size_t count);
TableCell number_cell(const char* name, Real value);  // as figure() writes it
// The line with the greatest value above 0, with all ties.
struct Leading {
  Real value = 0;
  std::vector<std::string> names = {};

  void offer(Real mine, const std::string& name);
  std::string text() const;  // "sip † and 2 more", "no method"
};
// The unit of costs of single runs: measured cost if rankings use work, else the same measure.
Measure cost_measure(const Comparison& comparison);
std::string cost_unit(const Comparison& comparison);
// "equivalent forward solves at measured cost", …
std::string priced_unit(const Comparison& comparison);
// The prices that the component metadata of this very problem hold, used or not; null where none.
const MeasuredPrices* prices_of(const ProblemAxis& problem);
const MeasuredPrice* price_of(const MeasuredPrices& prices, std::string_view oracle);
Real in_units(Measure by, Real value);  // as tables and axes have it: times in ms

struct MethodPair {
  std::size_t a = 0, b = 0;  // optimizers, a < b
  WorkRatio ratio;
};
// At the tightest tolerance by what the yardstick counts, over the settings that may be ranked and
// to which both methods apply.
std::vector<MethodPair> all_pairs(const Comparison& comparison);

// 95 % over families of each optimizer's score, or its range over few; infinite where not ranked.
std::vector<Interval> score_intervals(const Comparison& comparison);

}  // namespace isoline::reports
