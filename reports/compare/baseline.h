// The reference of a gate: one line per cell, small enough to be kept in a repository.
#pragma once

#include <string>
#include <vector>

#include "reports/compare/cells.h"

namespace isoline::reports {

inline constexpr const char* kBaselineSchema = "isoline.baseline/1";

// Keeps what is compared bit for bit (status, build, digest of the trace, final figures, work to
// the tolerances of the tables), with what was asked, given and built, and neither curves nor
// times. `perturbed` holds runs of the same cells from starts perturbed in the last bit, a study a
// perturbation: how far they moved is kept.
std::string baseline_json(const Study& study, const std::vector<Study>& perturbed = {});

std::vector<ComparedCell> baseline_from_json(const Json& json);  // UsageError if it is not valid

}  // namespace isoline::reports
