// The claims of the tree: their form, their cells, how they are chosen; and their verdicts on real
// runs, the notebook's and those of the learned problems that take seconds, also with planted
// falsehoods.

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "benchmarks/plan/claim_cells.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "reports/formats/formats.h"
#include "reports/report.h"
#include "reports/sections/sections.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {

using reports::judge;
using reports::Judgement;
using reports::Verdict;
namespace {

const std::vector<Claim>& claims() {
  static const std::vector<Claim> all = builtin_claims_of(catalog());
  return all;
}

std::set<std::string> cells_of_suites(const std::vector<std::string>& suites) {
  std::set<std::string> cells;
  for (const std::string& suite : suites)
    for (const Request& request : cells_of(suite)) cells.insert(cell_digest(request));
  return cells;
}

TEST(ClaimsOfTheTree, AreWellFormedAndEachIsThereOnce) {
  std::set<std::string> ids;
  for (const auto& [name, text] : builtin_claims()) {
    const Json file = parse_json(std::string(text), name);
    EXPECT_EQ(schema_violations(file, schema("claims")), std::vector<std::string>{}) << name;
    EXPECT_EQ(file.at("name"), name);
    ids.insert(name);  // a group's name must not be an id
  }
  for (const Claim& claim : claims()) EXPECT_TRUE(ids.insert(claim.id).second) << claim.id;
  EXPECT_GE(claims().size(), 120U);
}

TEST(ClaimsOfTheTree, ReuseTheCellsOfTheSuites) {
  const auto quick =
      cells_of_suites({"quick", "notebook", "sip-quick", "hig-quick", "fluid-quick"});
  const auto paper = cells_of_suites({"sip-paper", "hig-paper", "fluid-paper"});
  for (const Claim& claim : claims())
    for (const Claim::Cells& cells : claim.cells)
      for (const Request& request : cells.requests)
        EXPECT_TRUE((cells.is_long ? paper : quick).contains(cell_digest(request)))
            << claim.id << ": " << request.problem.spec << " × " << request.optimizer.spec;
}

TEST(ClaimsOfTheTree, DecideAtLeastTwelveByTheCellsOfTheShortSuites) {
  std::size_t decided = 0;
  for (const Claim& claim : claims()) {
    if (claim.cells.empty() || claim.json->contains("not_comparable") ||
        claim.json->contains("undecidable"))
      continue;
    const Claim::Cells& shortest = claim.cells.back();
    const Json& quantity = claim.json->at("quantity");
    const auto asked = quantity.value("iteration", std::int64_t{0});
    decided += !shortest.is_long && shortest.requests[0].budget.iterations >= asked;
  }
  EXPECT_GE(decided, 12U);
}

TEST(ClaimsOfTheTree, CountAFactByTheClaimThatLeadsIt) {
  std::map<std::string, std::string> facts;
  for (const Claim& claim : claims()) facts[claim.id] = claim.json->value("fact", claim.id);
  std::set<std::string> counted;
  for (const auto& [id, fact] : facts) {
    ASSERT_TRUE(facts.contains(fact)) << id << " counts with " << fact;
    EXPECT_EQ(facts.at(fact), fact) << id << " counts with what counts elsewhere";
    counted.insert(fact);
  }
  EXPECT_LT(counted.size(), facts.size());
}

TEST(ClaimsOfTheTree, AllowNoToleranceOfOurOwnAndSayInWholeSentencesHowTheyDiffer) {
  Json file = parse_json(std::string(builtin_claims().at("sine")), "sine");
  for (Json& claim : file["claims"])
    if (claim.at("tolerance").at("from") == "figure") claim["tolerance"]["relative"] = 0.5;
  EXPECT_FALSE(schema_violations(file, schema("claims")).empty());
  // Remarks are written one after the other.
  for (const char* text : {"a tenth of the steps.", "A tenth of the steps", " A tenth."}) {
    file = parse_json(std::string(builtin_claims().at("half-inverse")), "claims");
    ASSERT_TRUE(schema_violations(file, schema("claims")).empty());
    file["claims"][0]["cells"][0]["deviation"] = text;
    EXPECT_FALSE(schema_violations(file, schema("claims")).empty()) << text;
  }
}

TEST(ClaimsOfTheTree, SayOfThemselvesWhatTheirPapersDo) {
  const std::set<std::string> kinds = {"value", "ratio", "greatest"};
  std::set<std::string> guessed;
  std::size_t toys = 0;
  for (const Claim& claim : claims()) {
    SCOPED_TRACE(claim.id);
    // ±5 % is the error of a figure in a text, not of one that the text calls rough.
    for (const char* rough : {"about", "around", "orders of magnitude", "an order of magnitude"})
      EXPECT_FALSE(claim.sentence.find(rough) != std::string::npos &&
                   claim.json->at("tolerance").at("from") == "text");
    if (claim.id.starts_with("toy-")) {  // their settings are not published
      EXPECT_TRUE(claim.json->contains("undecidable"));
      ++toys;
    }
    if (claim.json->contains("length")) {
      const Json& length = claim.json->at("length");
      if (length.value("guessed", false)) guessed.insert(claim.id);
      // One that no set of its cells is long enough for could only ever be too short.
      EXPECT_TRUE(std::ranges::any_of(claim.cells, [&](const Claim::Cells& cells) {
        return cells.requests.at(0).budget.iterations >= length.at("iterations");
      }));
    }
    if (claim.id == "poisson-slowdown" || claim.id == "heat-slowdown") {
      EXPECT_TRUE(std::ranges::any_of(claim.cells.at(0).requests, [](const Request& request) {
        return request.optimizer.name == "adahessian";
      }));
    }
    if (claim.id.ends_with("-ray")) {  // to set out straight is not to arrive
      EXPECT_TRUE(std::ranges::any_of(claim.json->at("contrasts"), [](const Json& contrast) {
        return contrast.at("quantity").at("column") == "loss" &&
               contrast.at("published").contains("at_most");
      }));
    }
    // The published runs of learned problems were one each: their figures are compared with one.
    if (claim.cells.empty() || !claim.json->at("cells").at(0).contains("seeds")) continue;
    const Json &published = claim.json->at("published"), &quantity = claim.json->at("quantity");
    if (published.contains("value") && kinds.contains(quantity.at("kind")) &&
        quantity.at("column") != "milliseconds" && quantity.value("iteration", 1) > 0) {
      EXPECT_EQ(published.value("runs", 0), 1);
    }
  }
  EXPECT_EQ(toys, 24U);
  EXPECT_EQ(guessed, (std::set<std::string>{"sine-crossing", "sine-sip-level"}));
}

TEST(ClaimsOfTheTree, AreChosenByIdOrGroupAndRunWhatIsLongOnlyWhenAsked) {
  EXPECT_EQ(chosen_claims(claims(), {"notebook-gd-table"}).size(), 1U);
  EXPECT_EQ(chosen_claims(claims(), {}).size(), claims().size());
  EXPECT_THROW(chosen_claims(claims(), {"notebok"}), UsageError);
  const auto is_hours = [](const Request& request) { return request.hard_seconds > 3600; };
  EXPECT_TRUE(std::ranges::none_of(cells_of(claims(), false), is_hours));
  EXPECT_TRUE(std::ranges::any_of(cells_of(claims(), true), is_hours));
}

// --- verdicts

Json claims_of(const std::vector<std::string>& names) {
  return json_of(chosen_claims(claims(), names));
}

const std::vector<Record>& notebook() {
  static const FinishedMatrix all(catalog(), read_suite("notebook"), Rates::builtin());
  return all.records;
}

// The cells of sip-quick on Figures 2, 5b and 5c and on the toy: half a minute of one core.
std::vector<Record> run_learned() {
  std::vector<Request> requests = cells_of("sip-quick");
  std::erase_if(requests, [&](const Request& request) {
    return request.budget.iterations < 2000 || request.budget.iterations > 10'000 ||
           request.rates == "learn-tuned.json" ||
           request.problem.spec.find("phi") != std::string::npos ||
           request.problem.options.number("xi", 1) > 32;
  });
  return FinishedMatrix(catalog(), requests).records;
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
        << judgement.id << ": " << judgement.why << reports::measured_text(judgement);
}

TEST(VerdictsOnClaims, PlantedFalseOnesAreNotReproduced) {
  Json planted = claims_of({"notebook-gd-table", "notebook-newton-distance",
                            "notebook-sip-alignment", "sine-order-of-magnitude"});
  ASSERT_EQ(planted.size(), 4U);
  std::vector<Record> runs =
      FinishedMatrix(catalog(),
                     cells_of(chosen_claims(claims(), {"sine-order-of-magnitude"}), false))
          .records;
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
