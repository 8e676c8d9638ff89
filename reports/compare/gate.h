// Differences between two sets of results: the gate of continuous integration.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/results/times.h"
#include "core/status.h"
#include "reports/compare/cells.h"

namespace isoline::reports {

// Cells that NEW may lack, or may judge by another criterion of success. Patterns hold for a name,
// or for a specification as asked or as given; '*' stands for any text.
struct AllowedCells {
  std::string problem = "*", optimizer = "*", reason;
  bool is_of_criterion = false;
};
using AllowedList = std::vector<AllowedCells>;
inline constexpr const char* kAllowedSchema = "isoline.allowed/1";
AllowedList allowed_from_json(const Json& json);  // UsageError where it is no such list
AllowedList read_allowed(const std::filesystem::path& file);
bool matches(const std::string& pattern, const std::string& text);
bool is_of(const AllowedCells& entry, const ComparedCell& cell);

struct Pairs {
  std::vector<std::pair<const ComparedCell*, const ComparedCell*>> both;  // in the order of BASE
  std::vector<const ComparedCell*> only_before, only_after;
};
// The join of the two sides: by their keys; then by what was asked, as typed, with its seed and
// budget, since a changed default or rate changes the key; then by the options given. What two of a
// side have in common pairs neither. The cells must outlive the pairs.
Pairs paired(const std::vector<ComparedCell>& before, const std::vector<ComparedCell>& after);

enum class Change { worse, better, changed };

struct Difference {
  Change change = Change::changed;
  std::string key, title, problem, optimizer, what;
  std::string before, after;  // as shown
  Real relative = 0;          // (after − before) / |before|; infinite where that says nothing
  std::string note = {}, cause = {};  // why the two may differ
};
using Differences = std::vector<Difference>;
Difference difference_in(const ComparedCell& cell, Change change, const std::string& what,
                         const std::string& before, const std::string& after);
Difference status_difference(const ComparedCell& before, const ComparedCell& after);
int badness_of(Status status);  // the greater the worse

// The largest difference of each kind and direction, the parts of BASE that NEW lacks, and extra
// information that only one of them has. Without a tolerance, values agree if they are the same
// number; with one if they differ by no more than rounding, 1e-16 of the problem's scale, and that
// share of the first, or of 1e-6 of the scale where that is more: what is smaller solves the
// problem to the strictest target of the tables.
Differences figure_differences(const ComparedCell& before, const ComparedCell& after,
                               const std::optional<Real>& tolerance);
// The least tolerance within which the figures of the two agree; infinite where one is finite and
// the other is not, or where their status differs.
Real movement(const ComparedCell& before, const ComparedCell& after);

// "f_L 0 → 1e-3, aim x → loss": what of the criteria differs, by more than the tolerance where
// there is one; empty where nothing does.
std::string criterion_change_text(const ComparedCell& before, const ComparedCell& after,
                                  const std::optional<Real>& tolerance);

// Results that hang on the last bit of their start: rounding, and so another processor or library,
// moves them as it likes. What of them can still be judged is how they end and what they reach.

Perturbed perturbed_of(const ComparedCell& unperturbed, const std::vector<ComparedCell>& perturbed);
// Its figures moved by more than a tenth of the tolerance when the start was perturbed. Without a
// tolerance figures must be the same bit for bit, which chaotic cells of one build are too.
bool is_chaotic(const ComparedCell& cell, const std::optional<Real>& tolerance);
// A status that no run of BASE ended with, a coarse target that all of them reached and NEW does
// not, or that none of them reached and NEW does. What only some reached is no difference.
Differences coarse_differences(const ComparedCell& before, const ComparedCell& after);

// Differences between paired cells before any value differs. For options "adam: default of epsilon
// 1e-8 → 0.01"; for the build "another harness".
std::set<std::string> changed_options(const ComparedCell& before, const ComparedCell& after);
std::vector<std::string> changed_parts(const ComparedCell& before, const ComparedCell& after);

struct GateOptions {
  std::optional<Real> tolerance;  // relative; without it figures must agree bit for bit
  Real least_noise = kLeastNoise;
  AllowedList allowed;
  bool is_common_only = false;  // NEW may lack any cell
  Listener listener;            // of the records read
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
  std::map<Change, std::set<std::string>> changes = {};  // keys of cells
  std::size_t incomparable = 0;

  void add(const ComparedCell& cell);
  std::size_t count(Change change) const {
    const auto at = changes.find(change);
    return at == changes.end() ? 0 : at->second.size();
  }
};
std::string cells_text(const CauseGroup& group);  // "51 cells of adam, gd on 12 problems"
// "51 cells of adam, gd on 12 problems: 3 worse, 48 not comparable".
std::string cause_group_text(const CauseGroup& group);

struct GateResult {
  std::size_t joined = 0, equal = 0;          // cells in both; of them, without any difference
  std::size_t chaotic = 0;                    // of them, judged by status and coarse targets
  std::vector<std::string> builds, settings;  // what differs before any figure does, in words
  Differences differences;                    // worst first
  // Groups of differences and of cells that cannot be compared: groups with a regression first,
  // then those cannot be compared, then by their cells.
  std::vector<CauseGroup> causes;
  std::vector<TimeVerdict> times;                    // worst first
  std::vector<std::string> only_before, only_after;  // titles; the allowed ones are not among them
  std::string lack;                   // "NEW lacks 4 cells of adam on sine that BASE has"
  std::vector<ReasonedCell> allowed;  // only in BASE, or judged otherwise
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
std::string gate_json(const GateResult& result);  // the same tables: isoline.comparison/2

// Pieces of these texts.
std::string step_text(const Difference& difference);  // "loss 1e-3 → 2e-3"
std::string ratio_text(const RatioEstimate& ratio);   // "1.31× (1.25 to 1.36)"

}  // namespace isoline::reports
