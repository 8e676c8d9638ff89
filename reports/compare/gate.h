// Two sets of results as cells, and their differences: the gate of continuous integration.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/options.h"
#include "core/records/record.h"
#include "core/results/statistics.h"
#include "core/results/study.h"
#include "core/status.h"
#include "core/threads.h"

namespace isoline::reports {

using namespace results;

inline constexpr Real kSmallestShare = 1e-6;  // of a problem's scale: below, values are solved

// The figures of a cell that are compared. Less is better.
inline constexpr std::size_t kLoss = 0, kBestLoss = 1, kPath = 2, kXError = 3, kWork = 4,
                             kWorkToX = kWork + kTargets,
                             kUnverified = kWorkToX + kTolerances.size(),
                             kFigures = kUnverified + 1;
struct FigureKind {
  const char *key, *name;        // in a baseline; as shown
  std::size_t first, count = 1;  // its figures
};
inline constexpr FigureKind kFigureKinds[] = {
    {"loss", "loss", kLoss},
    {"best_loss", "best loss", kBestLoss},
    {"path", "mean loss of the path", kPath},
    {"x_error", "error in x", kXError},
    {"work", "work to reach ", kWork, kTargets},
    {"found", "work to reach an error in x of ", kWorkToX, kTolerances.size()},
    {"unverified", "targets missed by the last point", kUnverified}};
std::string figure_name(std::size_t figure);  // "work to reach 1e-3"
// The figure of one of the tolerances of the tables; the work in the sense of loss or of x.
constexpr std::size_t work_at(Aim aim, std::size_t tolerance) {
  return aim == Aim::x ? kWorkToX + tolerance : kWork + kTolerances[tolerance].rung;
}

// The results of runs that started one unit in the last place away.
struct Perturbed {
  Real moved = 0;                // the least tolerance within which all agree with the given start
  std::vector<Status> statuses;  // how each ended
  std::array<std::size_t, kTolerances.size()> reached{};  // of them, how many reached each target
};

struct ComparedCell {
  std::string key;    // the cell's digest
  std::string title;  // "heat × gd, seed 3"
  // As asked (of older records as given) and as given, with all options; cells share equal ones.
  std::shared_ptr<const Component> problem, optimizer;
  std::uint64_t seed = 0;
  std::string terms;  // budget and threads asked for
  Status status = Status::running;
  std::string build;
  std::shared_ptr<const BuildParts> parts;  // digests of its build's parts; none: unknown
  Criterion criterion = {};                 // of success
  std::vector<std::string> privileges;
  std::vector<Real> figures;    // (kFigures); not-a-number: unknown. Empty: none
  Real scale = 0, x_scale = 0;  // of its losses and of its error in x
  std::string trace, rest;      // digests of its path and of what else is deterministic
  std::vector<std::pair<std::string_view, std::uint64_t>> members;  // digests of that, by name
  std::vector<Real> seconds;                                        // repetitions
  std::vector<Real> x;              // of least loss, in a record that holds it
  std::size_t senseless_times = 0;  // of them, left out: infinite, or not a number
  std::string processor;
  bool is_cut = false;                 // a clock or a kill ended it
  std::size_t verdicts = 0;            // on its last point, that its record states
  std::string doubt;                   // why its record cannot be trusted; empty: it can
  std::string file;                    // of its record; empty: of a baseline
  std::optional<Perturbed> perturbed;  // where a baseline has measured it

  bool has(std::size_t figure) const { return !figures.empty() && !std::isnan(figures[figure]); }
};

std::vector<ComparedCell> compared_cells(const Study& study);

// A result folder, read record by record for its memory.
struct FolderCells {
  std::vector<ComparedCell> cells;  // by problem, optimizer, seed
  std::vector<Unreadable> unreadable = {};
  std::size_t superseded = 0;
};
FolderCells read_cells(const std::string& folder,  // UsageError if it does not exist
                       const Listener& listener = {});

// The reference of a gate, small enough for a repository: a line per cell with its request, build,
// status, digest of the trace, final figures and work to the tolerances; no curves, no times.
// `perturbed`: a study per perturbation of the starts' last bit, of which the movement is kept.
inline constexpr const char* kBaselineSchema = "isoline.baseline/1";
std::string baseline_json(const Study& study, const std::vector<Study>& perturbed = {});
// UsageError, which names the origin, if it is not valid.
std::vector<ComparedCell> baseline_from_json(const Json& json, const std::string& origin);

// Cells that NEW may lack, or may judge by another criterion of success. Patterns, with '*' for any
// text, hold for a name or a specification.
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

// Results that depend on the last bit of their start move with each processor and library. How they
// end, and what they reach, can still be judged.
Perturbed perturbed_of(const ComparedCell& unperturbed, const std::vector<ComparedCell>& perturbed);
// Its figures moved by more than a tenth of the tolerance when the start was perturbed. Without a
// tolerance figures must be the same bit for bit, which chaotic cells of one build are too.
bool is_chaotic(const ComparedCell& cell, const std::optional<Real>& tolerance);
// A status that no run of BASE ended with, a coarse target that all of them reached and NEW does
// not, or that none of them reached and NEW does. What only some reached is no difference.
Differences coarse_differences(const ComparedCell& before, const ComparedCell& after);

// Members that are compared beside the result of a record: rates, and counts of calls at its hits.
Json members_beside_results(const Record& record);

// Every other member of the two records, number by number: within the tolerance times the norm of
// x* for points, times the largest value of a column for others. Adds the members that a comparison
// with a tolerance leaves out.
Differences member_differences(const ComparedCell& before, const ComparedCell& after,
                               const std::optional<Real>& tolerance,
                               std::set<std::string>& uncompared);
// "the plan of NEW lacks 3 of 12 cells; rates.json of NEW is missing"; empty where nothing lacks.
// The component files of BASE count that are of these specs.
std::string folder_lack(const std::filesystem::path& before, const std::filesystem::path& after,
                        const std::set<std::string>& specs);

// Differences before any value differs: "adam: default of epsilon 1e-8 → 0.01", the harness.
std::set<std::string> changed_options(const ComparedCell& before, const ComparedCell& after);
std::vector<std::string> changed_parts(const ComparedCell& before, const ComparedCell& after);

struct GateOptions {
  std::optional<Real> tolerance;  // relative; without it figures must agree bit for bit
  Real least_noise = kLeastNoise;
  AllowedList allowed;
  bool is_common_only = false;  // NEW may lack any cell
  Listener listener;            // of the records read
};

// Why NEW may lack a cell, or why it cannot be compared.
struct ReasonedCell {
  std::string title, reason;
};

// The cells that differ for one reason (options or parts of the build), or that cannot be compared.
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
// "51 cells of adam, gd on 12 problems: 3 worse, 48 not comparable".
std::string cause_group_text(const CauseGroup& group);

struct GateResult {
  std::size_t joined = 0, equal = 0;          // cells in both; of them, without any difference
  std::size_t chaotic = 0;                    // of them, judged by status and coarse targets
  std::vector<std::string> builds, settings;  // what differs before any figure does, in words
  Differences differences;                    // worst first
  std::vector<CauseGroup> causes;             // regressions first, then what cannot be compared
  std::vector<TimeVerdict> times;             // worst first
  std::vector<std::string> only_before, only_after;  // titles; the allowed ones are not among them
  std::string lack;                   // "NEW lacks 4 cells of adam on sine that BASE has"
  std::vector<ReasonedCell> allowed;  // only in BASE, or judged otherwise
  std::vector<ReasonedCell> incomparable, elsewhere;  // the second: of equal loss, at another x
  std::vector<std::string> remarks;
  std::vector<Unreadable> unreadable;  // of both folders
  std::set<std::string> uncompared;    // members that a tolerance leaves out
  std::string verdict;                 // one sentence, which names the cause
  ExitCode exit_code = kGood;
};

// Two result folders, or a baseline and a result folder.
GateResult compare_results(const std::filesystem::path& before, const std::filesystem::path& after,
                           const GateOptions& options);

// The summary, then so many lines of tables as a reader reads, or all.
std::string gate_terminal(const GateResult& result, bool lists_all = false);
std::string gate_markdown(const GateResult& result);
std::string gate_json(const GateResult& result);  // the same tables: isoline.comparison/2

}  // namespace isoline::reports
