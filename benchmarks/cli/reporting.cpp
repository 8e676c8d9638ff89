// The one call of the report from the command line, with the claims that the runs decide.
#include "benchmarks/cli/reporting.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "benchmarks/cli/session.h"
#include "core/text.h"

namespace isoline::benchmarks {

using reports::compare_optimizers;
using reports::Document;
using reports::document_of;
using reports::judge;
using reports::Judgement;
using reports::Study;
using reports::terminal_table;
using reports::write_report;

std::vector<Judgement> judged(const std::vector<Claim>& claims, const std::vector<Record>& runs) {
  return judge(json_of(claims), runs);
}

void write_and_print(const Study& study, const std::filesystem::path& out, Session& session,
                     const Reporting& how) {
  std::vector<Judgement> claims = judged(builtin_claims_of(session.catalog()), study.runs);
  std::erase_if(claims, [](const Judgement& judgement) { return !judgement.is_covered; });
  Document document = document_of(compare_optimizers(study, how.yardstick), std::move(claims));
  document.out = out.string();
  write_report(document, out);
  if (!how.is_quiet)
    say(stdout,
        fmt::format("{}\nreport: {}\n", terminal_table(document), (out / "index.html").string()));
}

}  // namespace isoline::benchmarks
