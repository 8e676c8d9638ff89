// The audit: the properties of every optimizer, measured on problems with known solutions.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "core/records/sheet.h"

namespace isoline::benchmarks {

// At its defaults, except for floors, which break every scaling law: options named `epsilon` and
// `cutoff` are 0 if that is valid. The spec in the result shows this.
AuditedOptimizer audit_optimizer(const Catalog& catalog, const std::string& name);

// Each in its own process: a crash or a hang loses one audit only.
std::vector<AuditedOptimizer> audit_all(const Catalog& catalog,
                                        const std::vector<std::string>& names);

// The file that reports read, and its text.
std::string audit_text(const std::vector<AuditedOptimizer>& all);
void write_audit(const std::vector<AuditedOptimizer>& all, const std::filesystem::path& path);

// Fits log10 value = exponent · log10 scale + constant; no law if a value is not positive and
// finite.
PowerLaw power_law(const std::vector<Real>& scales, std::vector<Real> values);

// The order at which errors fall, from those above `floor`, until one no longer falls.
Approach approach_of(const std::vector<Real>& errors, Real floor);

}  // namespace isoline::benchmarks
