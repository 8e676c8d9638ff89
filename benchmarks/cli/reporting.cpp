// The one call of the report from the command line, with the claims that the runs decide.
#include "benchmarks/cli/reporting.h"

#include <fmt/format.h>

#include "benchmarks/cli/session.h"
#include "benchmarks/plan/claim_cells.h"
#include "reports/claims/claims.h"
#include "reports/report.h"

namespace isoline::benchmarks {

using reports::compare_optimizers;
using reports::Comparison;
using reports::judge;
using reports::Judgement;
using reports::Study;
using reports::terminal_table;
using reports::write_report;
namespace {

// The claims of the tree whose cells are among the runs, judged.
std::vector<Judgement> covered_claims(const Study& study, Session& session) {
  std::vector<Judgement> judgements =
      judge(json_of(builtin_claims_of(session.catalog())), study.runs);
  std::erase_if(judgements, [](const Judgement& judgement) { return !judgement.is_covered; });
  return judgements;
}

}  // namespace

void write_and_print(const Study& study, const std::filesystem::path& out, Session& session,
                     bool quiet) {
  Comparison comparison = compare_optimizers(study);
  comparison.claims = covered_claims(study, session);
  write_report(comparison, out);
  if (!quiet)
    fmt::print("{}\nreport: {}\n", terminal_table(comparison), (out / "index.html").string());
}

}  // namespace isoline::benchmarks
