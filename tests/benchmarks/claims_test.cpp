// The claims of the tree: their form, their cells, and how they are chosen.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/claim_cells.h"
#include "core/json.h"
#include "core/records/json_view.h"

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

bool is_among(const std::string& id, const std::vector<std::string>& parts) {
  return std::ranges::any_of(
      parts, [&](const std::string& part) { return id.find(part) != std::string::npos; });
}

// ±5 % is the error of a figure in a text, not of one that the text calls rough.
TEST(ClaimsOfTheTree, LeaveRoughFiguresRough) {
  for (const Claim& claim : claims())
    if (is_among(claim.sentence,
                 {"about", "around", "orders of magnitude", "an order of magnitude"})) {
      EXPECT_NE(claim.json->at("tolerance").at("from"), "text") << claim.id;
    }
}

TEST(ClaimsOfTheTree, WithoutTheirSettingsAreUndecidable) {
  std::size_t toys = 0;
  for (const Claim& claim : claims())
    if (claim.id.starts_with("toy-")) {
      EXPECT_TRUE(claim.json->contains("undecidable")) << claim.id;
      ++toys;
    }
  EXPECT_EQ(toys, 24U);
}

// The published runs of learned problems were one each: their figures are compared with one run.
TEST(ClaimsOfTheTree, SayThatAPublishedFigureIsOfOneRun) {
  const std::set<std::string> kinds = {"value", "ratio", "greatest"};
  for (const Claim& claim : claims()) {
    if (claim.cells.empty() || !claim.json->at("cells").at(0).contains("seeds")) continue;
    const Json &published = claim.json->at("published"), &quantity = claim.json->at("quantity");
    if (published.contains("value") && kinds.contains(quantity.at("kind")) &&
        quantity.at("column") != "milliseconds" && quantity.value("iteration", 1) > 0) {
      EXPECT_EQ(published.value("runs", 0), 1) << claim.id;
    }
  }
}

TEST(ClaimsOfTheTree, OfWhatSlowsDownIncludeAdaHessian) {
  for (const Claim& claim : claims())
    if (claim.id == "poisson-slowdown" || claim.id == "heat-slowdown") {
      EXPECT_TRUE(std::ranges::any_of(claim.cells.at(0).requests, [](const Request& request) {
        return request.optimizer.name == "adahessian";
      })) << claim.id;
    }
}

// Who only sets out straight has not gone straight to the solution.
TEST(ClaimsOfTheTree, OfTheStraightWayAskForArrival) {
  for (const Claim& claim : claims()) {
    if (!claim.id.ends_with("-ray")) continue;
    const Json& contrasts = claim.json->at("contrasts");
    EXPECT_TRUE(std::ranges::any_of(contrasts, [](const Json& contrast) {
      return contrast.at("quantity").at("column") == "loss" &&
             contrast.at("published").contains("at_most");
    })) << claim.id;
  }
}

TEST(ClaimsOfTheTree, OfGuessedLengthsSaySo) {
  std::set<std::string> guessed;
  for (const Claim& claim : claims())
    if (claim.json->contains("length") && claim.json->at("length").value("guessed", false))
      guessed.insert(claim.id);
  EXPECT_EQ(guessed, (std::set<std::string>{"sine-crossing", "sine-sip-level"}));
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
