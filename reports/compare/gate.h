// Differences between two sets of results: the gate of continuous integration.
//
//   cells        the two sides in one form: cells of a result folder or of a baseline
//   pairing      which cell of NEW answers which of BASE, and what was asked or built otherwise
//   differences  status and figures, exactly or within a tolerance; times, by statistics
//   gate         the verdict, and what explains it
//   baseline     what of results stands in a repository
//   gate_text    the comparison in words
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/results/statistics.h"
#include "core/status.h"
#include "core/threads.h"
#include "reports/compare/differences.h"
#include "reports/compare/pairing.h"

namespace isoline::reports {

using namespace results;

struct GateOptions {
  std::optional<Real> tolerance;  // relative; without it figures must agree bit for bit
  Real least_noise = kLeastNoise;
  std::vector<std::string> timed;  // beginnings of the keys of cells whose times are judged
  AllowedList allowed;             // cells that NEW may lack, or may judge by another criterion
  bool is_common_only = false;     // it may lack any
  Listener listener;               // of the records read
};

// A cell with the reason why NEW may lack it, or why its figures say nothing of those of BASE.
struct ReasonedCell {
  std::string title, reason;
};

// The cells that differ for one reason: their options, or the parts of the build that
// computed them; for those that cannot be compared, the reason. Cells count, not values.
struct CauseGroup {
  std::string cause = {};
  std::set<std::string> cells = {}, problems = {}, optimizers = {};
  std::set<std::string> worse = {}, better = {}, changed = {};  // keys of cells, rounding apart
  std::size_t incomparable = 0;
  Real most_rounding = 0;  // the largest of the differences that rounding explains, relative

  void add(const ComparedCell& cell);
  std::size_t rounded() const;     // cells that differ by rounding alone
  std::string cells_text() const;  // "51 cells of adam, gd on 12 problems"
};

// "51 cells of adam, gd on 12 problems: 3 worse, 48 by rounding alone (3e-15 at most)".
std::string cause_group_text(const CauseGroup& group);

struct GateResult {
  std::size_t joined = 0, equal = 0;          // cells in both; of them, without any difference
  std::size_t chaotic = 0;                    // of them, judged by status and coarse targets
  std::vector<std::string> builds, settings;  // what differs before any figure does, in words
  std::vector<Difference> differences;        // worst first
  // Groups of differences and of cells that cannot be compared: groups with a regression first,
  // then those cannot be compared, then by their cells.
  std::vector<CauseGroup> causes;
  std::vector<TimeVerdict> times;                    // worst first
  std::vector<std::string> only_before, only_after;  // titles; the allowed ones are not among them
  std::vector<CauseGroup> other_terms;  // of them, asked with another budget: "iterations 20 → 30"
  std::string lack;                     // which optimizers NEW lacks cells of
  std::vector<ReasonedCell> allowed;    // only in BASE, or judged otherwise
  std::vector<ReasonedCell> incomparable;
  std::vector<std::string> remarks;
  std::string verdict;  // one sentence, which names the cause
  ExitCode exit_code = kGood;
};

// Two result folders, or a baseline and a result folder.
GateResult compare_results(const std::filesystem::path& before, const std::filesystem::path& after,
                           const GateOptions& options);

// The summary, then so many lines of tables as a reader reads, or all.
std::string gate_terminal(const GateResult& result, bool lists_all = false);
std::string gate_markdown(const GateResult& result);
std::string gate_json(const GateResult& result);  // schema isoline.comparison/1

inline constexpr const char* kComparisonSchema = "isoline.comparison/1";

// Pieces of these texts.
std::string step_text(const Difference& difference);            // "loss 1e-3 → 2e-3"
std::string ratio_text(const RatioEstimate& ratio);             // "1.31× (1.25 to 1.36)"
std::string names_text(const std::vector<std::string>& names);  // a dozen of them at most

}  // namespace isoline::reports
