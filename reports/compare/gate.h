// What changed from one set of results to another: the gate of continuous integration.
//
//   subject      the two sides in one form: cells of a result folder or of a baseline
//   pairing      which cell of NEW answers which of BASE, and what was asked or built otherwise
//   differences  status and figures, exactly or within a tolerance
//   timing       times, by statistics
//   allowed      what NEW may lack
//   gate         the verdict
//   causes       what differs, by what explains it
//   baseline     what of results stands in a repository
//   gate_text    the comparison in words
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/threads.h"
#include "reports/compare/causes.h"
#include "reports/compare/differences.h"
#include "reports/compare/pairing.h"

namespace isoline::reports {

struct GateOptions {
  std::optional<Real> tolerance;  // relative; without it figures must agree bit for bit
  Real least_noise = kLeastNoise;
  std::vector<std::string> timed;  // beginnings of the keys of cells whose times are judged
  AllowedList allowed;             // cells that NEW may lack
  bool is_common_only = false;     // it may lack any
  Listener listener;               // of the records read
};

struct AllowedCell {
  std::string title, reason;
};

struct GateResult {
  std::size_t joined = 0, equal = 0;          // subjects in both; of them, without any difference
  std::size_t chaotic = 0;                    // of them, judged by status and coarse targets
  std::vector<std::string> builds, settings;  // what differs before any figure does, in words
  std::vector<Difference> differences;        // worst first
  std::vector<CauseGroup> causes;             // of them and of what cannot be compared
  std::vector<TimeVerdict> times;             // worst first
  std::vector<std::string> only_before, only_after;  // titles; the allowed ones are not among them
  std::vector<OtherTerms> other_terms;               // of them, asked with another budget
  std::string lack;                                  // which optimizers NEW lacks cells of
  std::vector<AllowedCell> allowed;                  // only in BASE
  std::vector<Incomparable> incomparable;
  std::vector<std::string> remarks;
  std::string verdict;  // one sentence, which names the cause
  ExitCode exit_code = kGood;
};

// Two result folders, or a baseline and a result folder.
GateResult compare_results(const std::filesystem::path& before, const std::filesystem::path& after,
                           const GateOptions& options);
GateResult compare_subjects(const std::vector<Subject>& before, const std::vector<Subject>& after,
                            const GateOptions& options);

// The summary, then so many lines of tables as a reader reads, or all.
std::string gate_terminal(const GateResult& result, bool lists_all = false);
std::string gate_markdown(const GateResult& result);
std::string gate_json(const GateResult& result);  // schema isoline.comparison/1

inline constexpr const char* kComparisonSchema = "isoline.comparison/1";

// The sentence and the exit code that a comparison ends with.

// Fills both in, once all else is there.
void conclude(GateResult& result, const GateOptions& options);

// Pieces of these texts.
const char* name_of(Change change);
const char* name_of_time(int change);
std::string counts_of(const GateResult& result);           // "3 cells in both: 3 equal, …"
std::string step_text(const Difference& difference);       // "loss 1e-3 → 2e-3"
std::string remainder_text(const Difference& difference);  // "+5 %, and 3 more of its kind"
std::string ratio_text(const RatioEstimate& ratio);        // "1.31× (1.25 to 1.36)"

}  // namespace isoline::reports
