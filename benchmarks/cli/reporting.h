// A study reported as `run` and `report` do it: every format in a folder, the main table on the
// terminal; and the claims that runs decide.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/plan/claim_cells.h"
#include "reports/report.h"

namespace isoline::benchmarks {

class Session;

struct Reporting {
  bool is_quiet = false;
  reports::Yardstick yardstick = {};
};
void write_and_print(const reports::Study& study, const std::filesystem::path& out,
                     Session& session, const Reporting& how = {});

std::vector<reports::Judgement> judged(const std::vector<Claim>& claims,
                                       const std::vector<Record>& runs);

}  // namespace isoline::benchmarks
