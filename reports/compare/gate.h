// What changed from one set of results to another: the gate of continuous integration.
//
//   subject       the two sides in one form
//   differences   figures, exactly or within a tolerance
//   chaos         what can be judged of results that hang on the last bit
//   timing        times, by statistics
//   gate          what joins and what does not; the verdict
//   sides         reads both: result folders, a baseline, reports
//   baseline      what of results stands in a repository
//   gate_words, gate_terminal, gate_markdown, gate_json
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/threads.h"
#include "reports/compare/differences.h"
#include "reports/compare/timing.h"

namespace isoline::reports {

struct GateOptions {
  std::optional<Real> tolerance;  // relative; without it figures must agree bit for bit
  Real least_noise = kLeastNoise;
  std::vector<std::string> timed;  // beginnings of the keys of cells whose times are judged
  bool is_common_only = false;     // cells that only BASE has do not count
  Listener listener;               // of the records read
};

struct Incomparable {
  std::string title, reason;
};

struct GateResult {
  std::size_t joined = 0, equal = 0;    // subjects in both; of them, without any difference
  std::size_t chaotic = 0;              // of them, judged by status and coarse targets
  std::vector<Difference> differences;  // worst first
  std::vector<TimeVerdict> times;       // worst first
  std::vector<std::string> only_before, only_after;  // titles
  std::vector<Incomparable> incomparable;
  std::vector<std::string> remarks;
  std::string verdict;  // one sentence
  int exit_code = 0;    // of the conventions: 0 good, 2 worse, 3 better only, 4 not comparable
};

// Two result folders; or a baseline and a folder; or two report.json, or one and a folder, which is
// then compared as a report.
GateResult compare_results(const std::filesystem::path& before, const std::filesystem::path& after,
                           const GateOptions& options);
GateResult compare_subjects(const std::vector<Subject>& before, const std::vector<Subject>& after,
                            const GateOptions& options);

std::string gate_terminal(const GateResult& result);
std::string gate_markdown(const GateResult& result);
std::string gate_json(const GateResult& result);  // schema isoline.comparison/1

inline constexpr const char* kComparisonSchema = "isoline.comparison/1";

}  // namespace isoline::reports
