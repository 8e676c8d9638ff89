// The claims of the tree: their form, their cells, and their verdicts on the notebook's runs, with
// the right labels, with planted falsehoods and with labels permuted.
#include "benchmarks/claims.h"

#include <algorithm>
#include <map>
#include <set>

#include "benchmarks/resources.h"
#include "core/json.h"
#include "core/schema.h"
#include "reports/claims.h"
#include "tests/benchmarks/matrix.h"

namespace isoline {
namespace {

const Catalog& catalog() {
  static const Catalog all = builtin_catalog();
  return all;
}

const std::vector<Claim>& claims() {
  static const std::vector<Claim> all = builtin_claims_of(catalog());
  return all;
}

Json schema() { return parse_json(std::string(builtin_schemas().at("claims")), "claims"); }

std::set<std::string> cells_of_suites(const std::vector<std::string>& suites) {
  std::set<std::string> cells;
  for (const std::string& suite : suites)
    for (const Request& request : expand(catalog(), read_suite(suite), Rates::builtin()))
      cells.insert(cell_digest(request));
  return cells;
}

const std::vector<Record>& notebook() {
  static const FinishedMatrix all(catalog(), read_suite("notebook"), Rates::builtin());
  return all.records;
}

Json notebook_claims() { return json_of(chosen_claims(claims(), {"notebook"})); }

std::size_t count(const Json& asked, const std::vector<Record>& runs, Verdict verdict) {
  const std::vector<Judgement> judgements = judge(asked, runs);
  return static_cast<std::size_t>(std::ranges::count(judgements, verdict, &Judgement::verdict));
}

TEST(ClaimsOfTheTree, AreWellFormedAndEachIsThereOnce) {
  std::set<std::string> ids;
  for (const auto& [name, text] : builtin_claims()) {
    const Json file = parse_json(std::string(text), name);
    EXPECT_EQ(schema_violations(file, schema()), std::vector<std::string>{}) << name;
    EXPECT_EQ(file.at("name"), name);
    ids.insert(name);  // a group's name must not be an id
  }
  for (const Claim& claim : claims()) EXPECT_TRUE(ids.insert(claim.id()).second) << claim.id();
  EXPECT_GE(claims().size(), 60U);
}

TEST(ClaimsOfTheTree, ReuseTheCellsOfTheSuites) {
  const auto quick = cells_of_suites({"quick", "notebook", "sip-quick"});
  const auto paper = cells_of_suites({"sip-paper"});
  for (const Claim& claim : claims())
    for (const Claim::Cells& cells : claim.cells)
      for (const Request& request : cells.requests)
        EXPECT_TRUE((cells.is_long ? paper : quick).contains(cell_digest(request)))
            << claim.id() << ": " << request.problem.spec << " × " << request.optimizer.spec;
}

TEST(ClaimsOfTheTree, DecideAtLeastTwelveByTheCellsOfTheShortSuites) {
  std::size_t decided = 0;
  for (const Claim& claim : claims()) {
    if (claim.cells.empty() || claim.json.contains("not_comparable")) continue;
    const Claim::Cells& shortest = claim.cells.back();
    const Json& quantity = claim.json.at("quantity");
    const auto asked = quantity.value("iteration", std::int64_t{0});
    decided += !shortest.is_long && shortest.requests[0].budget.iterations >= asked;
  }
  EXPECT_GE(decided, 12U);
}

TEST(ClaimsOfTheTree, AllowNoToleranceOfOurOwnChoosing) {
  Json file = parse_json(std::string(builtin_claims().at("sine")), "sine");
  for (Json& claim : file["claims"])
    if (claim.at("tolerance").at("from") == "figure") claim["tolerance"]["relative"] = 0.5;
  EXPECT_FALSE(schema_violations(file, schema()).empty());
}

TEST(ClaimsOfTheTree, OfTheNotebookAreAllReproduced) {
  const std::vector<Judgement> judgements = judge(notebook_claims(), notebook());
  EXPECT_GE(judgements.size(), 12U);
  for (const Judgement& judgement : judgements)
    EXPECT_EQ(judgement.verdict, Verdict::reproduced)
        << judgement.id << ": " << judgement.why << measured_text(judgement);
}

TEST(ClaimsOfTheTree, PlantedFalseOnesAreNotReproduced) {
  Json planted = json_of(chosen_claims(
      claims(), {"notebook-gd-table", "notebook-newton-distance", "notebook-sip-alignment"}));
  ASSERT_EQ(planted.size(), 3U);
  for (Json& claim : planted) {
    Json& published = claim["published"];
    if (published.contains("table"))
      published["table"][9][1] = 0.97;  // 0.9617 there
    else
      published["value"] = 1.01 * published["value"].get<Real>();
  }
  EXPECT_EQ(count(planted, notebook(), Verdict::not_reproduced), 3U);
}

// Labels of the methods on one problem go round by one, two, …: every run then answers to another.
TEST(ClaimsOfTheTree, WithLabelsPermutedAtMostOneInTenIsReproduced) {
  std::vector<Record> runs;
  for (const Record& record : notebook())
    if (record.request.problem.name == "square") runs.push_back(record);
  Json asked = Json::array();
  for (const Json& claim : notebook_claims())  // what is said of the start is said of no method
    if (claim.at("quantity").value("iteration", 1) > 0) asked.push_back(claim);
  std::size_t reproduced = 0, judged = 0;
  for (std::size_t turn = 1; turn < runs.size(); ++turn) {
    std::vector<Record> turned = runs;
    for (std::size_t i = 0; i < runs.size(); ++i)
      turned[i].cell = runs[(i + turn) % runs.size()].cell;
    reproduced += count(asked, turned, Verdict::reproduced);
    judged += asked.size();
  }
  EXPECT_GE(judged, 100U);
  EXPECT_LE(10 * reproduced, judged) << reproduced << " of " << judged;
}

TEST(ClaimsOfTheTree, AreChosenByIdOrGroupAndAMisspeltOneIsAnError) {
  EXPECT_EQ(chosen_claims(claims(), {"notebook-gd-table"}).size(), 1U);
  EXPECT_EQ(chosen_claims(claims(), {}).size(), claims().size());
  EXPECT_THROW(chosen_claims(claims(), {"notebok"}), UsageError);
}

TEST(ClaimsOfTheTree, RunWhatIsLongOnlyWhenAsked) {
  const auto is_hours = [](const Request& request) { return request.hard_seconds > 3600; };
  EXPECT_TRUE(std::ranges::none_of(cells_of(claims(), false), is_hours));
  EXPECT_TRUE(std::ranges::any_of(cells_of(claims(), true), is_hours));
}

}  // namespace
}  // namespace isoline
