// The claims of the tree: their form, their cells, and how they are chosen.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/claim_cells.h"
#include "core/json.h"
#include "core/records/schema.h"

namespace isoline::benchmarks {
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

TEST(ClaimsOfTheTree, AreWellFormedAndEachIsThereOnce) {
  std::set<std::string> ids;
  for (const auto& [name, text] : builtin_claims()) {
    const Json file = parse_json(std::string(text), name);
    EXPECT_EQ(schema_violations(file, schema()), std::vector<std::string>{}) << name;
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
    if (claim.cells.empty() || claim.json->contains("not_comparable")) continue;
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

// A claim that no set of its cells is long enough for could only ever be too short.
TEST(ClaimsOfTheTree, AreLongEnoughInOneOfTheirSets) {
  for (const Claim& claim : claims()) {
    if (!claim.json->contains("length")) continue;
    const auto needed = claim.json->at("length").at("iterations").get<std::int64_t>();
    EXPECT_TRUE(std::ranges::any_of(claim.cells, [&](const Claim::Cells& cells) {
      return cells.requests.at(0).budget.iterations >= needed;
    })) << claim.id;
  }
}

TEST(ClaimsOfTheTree, AllowNoToleranceOfOurOwnChoosing) {
  Json file = parse_json(std::string(builtin_claims().at("sine")), "sine");
  for (Json& claim : file["claims"])
    if (claim.at("tolerance").at("from") == "figure") claim["tolerance"]["relative"] = 0.5;
  EXPECT_FALSE(schema_violations(file, schema()).empty());
}

// Remarks are written one after the other.
TEST(ClaimsOfTheTree, SayInWholeSentencesHowTheyDiffer) {
  for (const char* text : {"a tenth of the steps.", "A tenth of the steps", " A tenth."}) {
    Json file = parse_json(std::string(builtin_claims().at("half-inverse")), "claims");
    ASSERT_TRUE(schema_violations(file, schema()).empty());
    file["claims"][0]["cells"][0]["deviation"] = text;
    EXPECT_FALSE(schema_violations(file, schema()).empty()) << text;
  }
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
}  // namespace isoline::benchmarks
