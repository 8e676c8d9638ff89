// Claims of papers judged by records: what is read off runs, the quantities made of it, the
// verdict, and the sections that show them. A claim is JSON, form isoline.claims/1, in which each
// set of cells also has what makes it findable among records: "iterations" and, for each term of
// the quantity and of its contrasts, its alternatives as {"title", "cells"}: a digest a seed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/real.h"
#include "core/records/record.h"
#include "core/results/statistics.h"
#include "reports/sections/section.h"

namespace isoline::reports {

using namespace results;

// Where a figure of a run is read: a column of its curve or a quantity of its path, at an
// iteration, or when so much processor time has passed or work been counted, or at the end where
// none is named.
struct Place {
  std::string column;  // "series: …" is a quantity of the problem's own
  std::optional<std::int64_t> iteration;
  std::optional<Real> seconds;
  std::optional<std::int64_t> work;
  std::vector<std::vector<Real>> table;  // of deviations: at iterations 1, 2, …; one row: there
};

// A printed row of figures and the point of the path that stands beside it.
struct PrintedRow {
  std::int64_t iteration = 0;
  std::vector<Real> printed, reached;
};
// At iterations 1, 2, …; a single row at the place's iteration. Nothing if the path is shorter.
std::vector<PrintedRow> printed_rows(const Record& record, const Place& place);

std::size_t index_at(const Curve& curve, const Place& place);  // the last kept point until there
// "until: loss 0.1" is what was spent until the loss was no more than 0.1, "work until: loss 0.1"
// the same in work: the column, the bound.
bool is_level(const std::string& column);
std::pair<std::string, Real> bound_of(const std::string& column);
Real figure_of(const Record& record, const Place& place);  // not-a-number where it has none
std::string column_words(const std::string& column);       // "error in x"

// Quantities of terms by their medians: value (of the first), greatest, ratio (first over second),
// slope of log m over log at, crossing (where the first half of the terms passes from below the
// second half to above it, in `at`), position (of the first, from 1; a tie counts half), order
// (Kendall's τ with that of the terms). Of the first half of the terms over the second: ratio_slope
// and trend, the slope and the order of these ratios. mean_difference, of means over all runs of
// two terms, and share are not of medians.
Real quantity_of(const std::string& kind, const std::vector<Real>& medians,
                 const std::vector<Real>& at);
// The value of a quantity that indicates no direction; nothing if it has no such value.
std::optional<Real> neutral_of(const std::string& kind);

// One term of a quantity: of its alternatives that of the least median counts, or of the greatest.
struct Term {
  std::vector<std::vector<Real>> figures;  // [alternative][seed]
  Real at = 1, scale = 1;                  // its abscissa, and a factor of its figures
  bool is_worst = false;
};
struct Chosen {
  std::size_t alternative = 0;
  Real level = 0;  // the scaled median of its figures
};
Chosen chosen_of(const Term& term);  // over all seeds

struct Measurement {
  Real value = 0;
  Real low = 0, high = 0;       // 95 % of the bootstrap over seeds, of few their range; nan of one
  std::size_t n = 0;            // seeds
  std::vector<Real> each = {};  // of each seed by itself
  std::optional<Interval> predicted = {};  // 95 % of one further run, where logarithms tell
  // How runs vary by shorter ones, six or more, where there is a single one of the whole length.
  std::size_t shorter_runs = 0;
  Real deviation_of_shorter = 0;  // on the scale of the verdict
};
// All terms are resampled by the same seeds: a ratio stays between runs of equal start and data.
Measurement measure(const std::string& kind, const std::vector<Term>& terms,
                    const std::string& stream);

// From the strongest to the weakest, then those that decide nothing.
enum class Verdict {
  reproduced,  // it agrees, over six or more runs; or it is an identity that holds
  agrees,
  partly,     // one of its readings agrees, and another one does not
  too_noisy,  // to tell a factor of two, or which side of a threshold
  one_run,    // of a method with randomness: its spread is unknown
  differs,
  too_short,
  undecidable,  // what a run would need was not published
  not_comparable
};
inline constexpr std::array<std::string_view, 9> kVerdictNames = {
    "reproduced", "agrees",    "partly",      "too noisy",     "one run",
    "differs",    "too short", "undecidable", "not comparable"};
inline std::string_view name_of(Verdict verdict) {
  return kVerdictNames[static_cast<std::size_t>(verdict)];
}
inline bool is_decided(Verdict verdict) { return verdict < Verdict::too_short; }
inline bool is_supported(Verdict verdict) { return verdict <= Verdict::agrees; }
// Combines two readings of one claim: the weaker verdict, or partly if only one supports the claim
// and the other contradicts it.
inline Verdict joint_verdict(Verdict one, Verdict other) {
  const auto [stronger, weaker] = std::minmax(one, other);
  if (is_supported(stronger) && weaker == Verdict::differs) return Verdict::partly;
  return weaker;
}

// The published value with its error: the values that agree with it. A tie does not agree with a
// claim about which is better, so such a band ends where the tie begins, without it.
struct Agreement {
  Real low = -kNever, high = kNever;
  bool is_low_open = false, is_high_open = false;

  bool holds(Real value) const {
    return (is_low_open ? value > low : value >= low) &&
           (is_high_open ? value < high : value <= high);
  }
};
Agreement agreement_of(const nlohmann::json& claim);  // or of a contrast

// The one rule, for a claim or for its contrast. Of a published value, on the scale on which runs
// are normal (logarithms of what is positive): with d the distance of the mean of n runs from it,
// e = t₍n−1₎ s √(1 + 1/n) the error of one further run, and w the half-width of the stated error,
// at least ln 1.1, it differs if |d| > √(e² + w²); otherwise the runs are too noisy if e > ln 2,
// and agree if not. Of a threshold by a one-sided t interval of the mean; of an order, or where
// runs failed, by the share of seeds that bear it out, which must be above ½. Runs without
// randomness are exact: e = 0.
Verdict verdict_of(const Measurement& measured, const nlohmann::json& claim, bool is_drawn);
// How runs vary, on that scale; nothing of fewer than two or where some have no finite value there.
std::optional<Real> deviation_of_runs(const Measurement& measured, const nlohmann::json& claim);

// How many seeds lie on the published side of a tie, and the two-sided p of that by signs.
struct Direction {
  std::size_t with = 0, seeds = 0;
  Real p = 1;
};
std::optional<Direction> direction_of(const Measurement& measured, const nlohmann::json& claim);

// Whether terms of one problem are of several optimizers, in the claim or in its contrasts.
bool has_rivals(const nlohmann::json& claim);
Real published_value(const nlohmann::json& published);

// Each term of the quantity of a claim as it was read, run by run, with the curve it was read off.
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

// One of the lengths at which a claim can be decided.
struct CellSet {
  std::int64_t iterations = 0;
  std::size_t planned = 0, here = 0;  // cells, each once
  bool is_long = false;               // hours: run only when asked for
  bool is_deciding = false;
};
bool takes_hours(const std::vector<CellSet>& sets);  // the deciding one, or all if none decides
// The command that runs the claim again, in a folder of its own.
std::string repeat_command(const std::string& id, const std::vector<CellSet>& sets);

// The comparison that can refute a claim: a bound that every method satisfies says nothing of one.
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
  std::string id, sentence, source, quantity, published;
  std::vector<std::string> caveats;
  std::string paper, place;  // of the source: "Someone (2022)", "Figure 1"
  std::string fact;          // the claim whose fact this one restates, or itself
  Verdict verdict = Verdict::not_comparable;
  std::string why;        // it is too short, undecidable, or not comparable
  std::string reading;    // how the published figure was read off a plot, where it was
  std::string deviation;  // of the cells from the source, a sentence
  std::string reached;    // the share of its iterations and seeds that published records have
  std::optional<Measurement> measured;
  std::optional<Direction> direction;
  std::string break_even;  // of a comparison by the clock: what a step may cost
  std::optional<Agreement> band;
  Evidence evidence;          // none where nothing decides it
  std::vector<CellSet> sets;  // the longest first
  std::vector<Contrast> contrasts;
  std::vector<OtherReading> others;   // the verdict is what all of them bear
  std::optional<Verdict> alone;       // of the first reading, if the others changed the verdict
  std::vector<std::string> cells;     // that decide it, of those there are
  std::vector<std::string> survives;  // nulls under which it would come out no worse, in words
  std::int64_t needs = 0;             // iterations
  Real seconds = 0;                   // that these cells took, one after the other
  bool is_drawn = false;              // its runs are of seeds, of which others could be drawn
  bool is_of_one_run = false;         // the published figure
  bool is_verification = false;       // of runs that no seed varies: an identity, or printed digits
  bool is_covered = false;            // all cells of one of its lengths are among the records
};

// In the order of the claims. The first set of cells that is complete counts: the longest. After
// the runs, published records count, also those of fewer iterations and seeds than a claim asks
// for.
std::vector<Judgement> judge(const nlohmann::json& claims, const std::vector<Record>& runs,
                             const std::vector<Record>& published = {});
// The verdict on each fact, the weakest of the decided claims that restate it: of verifications, or
// of all others.
std::vector<Verdict> verdicts_on_facts(const std::vector<Judgement>& judgements,
                                       bool is_verification);

Section claims_section(const std::vector<Judgement>& judgements);
Section claims_summary(const std::vector<Judgement>& judgements);  // a line each, the refuted first
Section claim_section(const Judgement& judgement);  // one of them whole, with its evidence
// A table a paper: what it says, and the command, the time and the verdict of each claim.
Section papers_section(const std::vector<Judgement>& judgements);
Section items_section(const nlohmann::json& papers);  // benchmarks/papers.json: the texts' contents
std::string claims_reading(const std::vector<Judgement>& judgements);  // how many of each verdict
std::string verdict_text(const Judgement& judgement);                  // "partly on 3 seeds"
std::string marked_verdict(const Judgement& judgement);                // "≈ partly on 3 seeds"
std::vector<Reading> claim_notes(const Judgement& judgement);          // beside its figures
std::string measured_text(const Judgement& judgement);                 // "23.4 (18.2–31), n = 3"
// The distinguishing name of a term: its optimizer, its problem if they differ, its abscissa.
std::vector<std::string> term_names(const Evidence& evidence);
// One plot, or none where the figures have no curve and no abscissa.
std::vector<Plot> claim_plots(const Evidence& evidence, const std::string& id);

}  // namespace isoline::reports
