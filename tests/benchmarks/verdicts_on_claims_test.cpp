// Verdicts of the tree's claims on real runs: the notebook's, and those of the learned problems
// that take seconds. With the right labels, with planted falsehoods, and with the optimizers'
// labels permuted, which a claim that names an optimizer must not survive.
#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <ranges>

#include "benchmarks/plan/claim_cells.h"
#include "core/files.h"
#include "core/random.h"
#include "reports/formats/formats.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {

using reports::judge;
using reports::Judgement;
using reports::measured_text;
using reports::Verdict;
namespace {

Json claims_of(const std::vector<std::string>& names) {
  return json_of(chosen_claims(builtin_claims_of(catalog()), names));
}

const std::vector<Record>& notebook() {
  static const FinishedMatrix all(catalog(), read_suite("notebook"), Rates::builtin());
  return all.records;
}

std::vector<Record> run_of(const std::vector<Request>& requests) {
  return FinishedMatrix(catalog(), requests).records;
}

// The cells of sip-quick on Figures 2, 5b and 5c and on the toy: half a minute of one core.
std::vector<Record> run_learned() {
  std::vector<Request> requests = expand(catalog(), read_suite("sip-quick"), Rates::builtin());
  std::erase_if(requests, [&](const Request& request) {
    return request.budget.iterations < 2000 || request.budget.iterations > 10'000 ||
           request.rates == "learn-tuned.json" ||
           request.problem.spec.find("phi") != std::string::npos ||
           request.problem.options.number("xi", 1) > 32;
  });
  return run_of(requests);
}

// Reproduced, or consistent with what was published by few seeds.
std::size_t supported(const std::vector<Judgement>& judgements) {
  return static_cast<std::size_t>(
      std::ranges::count_if(judgements, reports::is_supported, &Judgement::verdict));
}

TEST(VerdictsOnClaims, OfTheNotebookAreAllReproduced) {
  std::vector<Judgement> judgements = judge(claims_of({"notebook"}), notebook());
  std::erase_if(judgements, [](const Judgement& judgement) { return !judgement.is_covered; });
  EXPECT_GE(judgements.size(), 20U);
  for (const Judgement& judgement : judgements)
    EXPECT_EQ(judgement.verdict, Verdict::reproduced)
        << judgement.id << ": " << judgement.why << measured_text(judgement);
}

TEST(VerdictsOnClaims, PlantedFalseOnesAreNotReproduced) {
  Json planted = claims_of({"notebook-gd-table", "notebook-newton-distance",
                            "notebook-sip-alignment", "sine-order-of-magnitude"});
  ASSERT_EQ(planted.size(), 4U);
  std::vector<Record> runs = run_of(
      cells_of(chosen_claims(builtin_claims_of(catalog()), {"sine-order-of-magnitude"}), false));
  runs.insert(runs.end(), notebook().begin(), notebook().end());
  EXPECT_EQ(supported(judge(planted, runs)), 4U) << "as published";
  for (Json& claim : planted) {
    Json& published = claim["published"];
    if (published.contains("table"))
      published["table"][9][1] = 0.97;  // 0.9617 there
    else if (published.contains("value"))
      published["value"] = 1.01 * published["value"].get<Real>();
    else  // SIP an order of magnitude farther than Adam, instead of nearer
      published = {{"at_most", 0.1}};
  }
  EXPECT_EQ(supported(judge(planted, runs)), 0U);
}

// One test for both halves, because the runs take half a minute.
TEST(VerdictsOnClaims, OfLearnedProblemsAreDecidedAndMostlySupported) {
  const std::vector<Judgement> judgements = judge(claims_of({}), run_learned());
  EXPECT_GE(std::ranges::count_if(judgements, reports::is_decided, &Judgement::verdict), 7);
  // Three seeds are a range: what reaches into the band without lying in it is consistent.
  EXPECT_GE(supported(judgements), 6U);
}

// docs/papers.md is made by `claims --papers`: each claim as it stands, and what no chance has a
// part in as these runs decide it. Learned ones stand as the runs that made the page decide them.
TEST(PapersPage, HasARowForEachClaimAndTheVerdictsOfTheNotebook) {
  const std::string page = read_text(std::filesystem::path(ISOLINE_SOURCE_DIR) / "docs/papers.md");
  const std::vector<Judgement> judgements = judge(claims_of({}), notebook());
  std::size_t rows = 0;
  for (const reports::Table& table : reports::papers_section(judgements).tables)
    for (const auto& row : table.rows) {
      std::string start = "|", end = "|";
      for (std::size_t i = 0; i < 3; ++i) start += " " + reports::markdown_text(row[i].text) + " |";
      for (std::size_t i = 4; i < row.size(); ++i)
        end += " " + reports::markdown_text(row[i].text) + " |";
      const std::size_t at = page.find("\n" + start);
      ASSERT_NE(at, std::string::npos) << start << " make the page anew";
      const std::string line = page.substr(at + 1, page.find('\n', at + 1) - at - 1);
      if (row.back().text.ends_with("verified")) {
        EXPECT_TRUE(line.ends_with(end)) << line;
      }
      ++rows;
    }
  EXPECT_EQ(rows, judgements.size());
}

}  // namespace
}  // namespace isoline::benchmarks
