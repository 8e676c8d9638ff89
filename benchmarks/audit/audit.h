// The audit: the properties of every optimizer, measured on problems with known solutions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "core/records/record.h"
#include "core/records/sheet.h"

namespace isoline::benchmarks {

// At its defaults, except for floors, which break every scaling law: options named `epsilon` and
// `cutoff` are 0 if that is valid. The spec in the result shows this.
AuditedOptimizer audit_optimizer(const Catalog& catalog, const std::string& name);

// Each in its own process: a crash or a hang loses one audit only.
std::vector<AuditedOptimizer> audit_all(const Catalog& catalog,
                                        const std::vector<std::string>& names);

// The table of conduct: each method on the problem `conduct`, run by the runner into the folder.
struct ConductRun {
  std::string name;   // "E3"
  std::string input;  // of the problem, in brackets
  std::int64_t work = 20'000;
  int threads = 1;
};
const std::vector<ConductRun>& conduct_runs();
// The cells of one method, from its records by the names of the runs.
std::vector<ConductCell> conduct_of(const Catalog& catalog,
                                    const std::map<std::string, Record>& records);
// Adds them to each of these audits.
void measure_conduct(const Catalog& catalog, std::vector<AuditedOptimizer>& audits,
                     const std::filesystem::path& folder);

// The file that reports read, and its text.
std::string audit_text(const std::vector<AuditedOptimizer>& all);
void write_audit(const std::vector<AuditedOptimizer>& all, const std::filesystem::path& path);

// Fits log10 value = exponent · log10 scale + constant; no law if a value is not positive and
// finite.
PowerLaw power_law(const std::vector<Real>& scales, std::vector<Real> values);

// The order at which errors fall, from those above `floor`, until one no longer falls.
Approach approach_of(const std::vector<Real>& errors, Real floor);

}  // namespace isoline::benchmarks
