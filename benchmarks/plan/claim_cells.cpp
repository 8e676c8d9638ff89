// Claims read from JSON, their cells expanded like those of suites.
#include "benchmarks/plan/claim_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/suite.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

struct Expansion {
  const Catalog& catalog;
  const Rates& rates;
  std::string claim;  // its id, for errors
};

std::vector<Request> expanded(const Expansion& from, Json block) {
  constexpr std::uint64_t kMost = 10'000;  // cells that decide one claim
  Json matrix = Json::array({block});
  const Json budgets = block.value("budgets", Json::object());
  // An optimizer with a budget of its own is a block of its own.
  for (const auto& [optimizer, budget] : budgets.items()) {
    auto& others = matrix[0]["optimizers"].get_ref<Json::array_t&>();
    require(std::erase(others, Json(optimizer)) == 1, [&] {
      return fmt::format("the claim {} states a budget of {}, which is not among its optimizers",
                         from.claim, optimizer);
    });
    Json& own = matrix.emplace_back(block);
    own["optimizers"] = {optimizer};
    own["budget"] = budget;
  }
  std::erase_if(matrix.get_ref<Json::array_t&>(), [&](Json& part) {
    for (const char* own : {"long", "deviation", "stands_in", "budgets"}) part.erase(own);
    return part["optimizers"].empty();
  });
  const Json suite{{"schema", "isoline.suite/1"}, {"name", "claims"}, {"matrix", matrix}};
  const std::string origin = "the claim " + from.claim;
  return expand(from.catalog, suite_from_json(suite, origin), from.rates, kMost);
}

// The one problem of the set, unless the term names its own.
std::string problem_of(const Expansion& from, const Json& term, const Json& block) {
  if (term.contains("problem")) return term["problem"];
  require(block.at("problems").size() == 1, [&] {
    return fmt::format("the claim {} must state the problem of each term", from.claim);
  });
  return block["problems"][0];
}

// One alternative for a term: the cells of an optimizer on a problem, one digest per seed.
Json alternative(const Expansion& from, const std::string& problem, const std::string& optimizer,
                 Json block, const std::set<std::string>& known) {
  block["problems"] = {problem};
  block["optimizers"] = {optimizer};
  if (block.contains("budgets")) {
    block["budget"] = block["budgets"].value(optimizer, block["budget"]);
    block.erase("budgets");
  }
  Json cells = Json::array();
  for (const Request& request : expanded(from, block)) {
    cells.push_back(request.cell);
    require(known.contains(cells.back()), [&] {
      return fmt::format("{} × {} is not among the cells of the claim {}", problem, optimizer,
                         from.claim);
    });
  }
  return {{"title", fmt::format("{} × {}", problem, optimizer)}, {"cells", cells}};
}

Json terms_of(const Expansion& from, const Json& quantity, const Json& block,
              const std::set<std::string>& known) {
  Json terms = Json::array();
  for (const Json& term : quantity.at("terms")) {
    const Json& optimizer = term.at("optimizer");
    const Json all = optimizer.is_array() ? optimizer : Json::array({optimizer});
    Json alternatives = Json::array();
    for (const Json& one : all)
      alternatives.push_back(alternative(from, problem_of(from, term, block), one, block, known));
    terms.push_back(std::move(alternatives));
  }
  return terms;
}

Claim claim_from(const Catalog& catalog, const Rates& rates, const Json& json,
                 const std::string& group) {
  const auto own = std::make_shared<Json>(json);
  Claim claim{.group = group,
              .id = json.at("id"),
              .sentence = json.at("sentence"),
              .json = own,
              .cells = {}};
  const Expansion from{catalog, rates, claim.id};
  if (!json.contains("cells")) return claim;
  for (Json& block : (*own)["cells"]) {
    Claim::Cells cells{block.value("long", false), expanded(from, block)};
    std::set<std::string> known;
    for (const Request& request : cells.requests) known.insert(request.cell);
    block["iterations"] = cells.requests.at(0).budget.iterations;
    Json bare = block;
    bare.erase("iterations");
    block["terms"] = terms_of(from, json.at("quantity"), bare, known);
    for (const Json& contrast : json.value("contrasts", Json::array()))
      block["contrast_terms"].push_back(terms_of(from, contrast.at("quantity"), bare, known));
    claim.cells.push_back(std::move(cells));
  }
  return claim;
}

}  // namespace

std::vector<Claim> claims_from_json(const Catalog& catalog, const Rates& rates, const Json& file,
                                    const std::string& origin) {
  require_valid(file, "claims", origin);
  std::vector<Claim> claims;
  for (const Json& json : file.at("claims"))
    claims.push_back(claim_from(catalog, rates, json, file.at("name")));
  return claims;
}

std::vector<Claim> builtin_claims_of(const Catalog& catalog) {
  const Rates rates = Rates::builtin();
  std::vector<Claim> all;
  for (const auto& [name, text] : builtin_claims())
    for (Claim& claim : claims_from_json(catalog, rates, parse_json(std::string(text), name), name))
      all.push_back(std::move(claim));
  return all;
}

namespace {

// There are too many names to list. The suggestions are those that share the most words with the
// given one.
std::string unknown_claim(const std::string& wrong, const std::vector<std::string>& known) {
  constexpr std::size_t kMost = 5;
  std::vector<std::string> words;
  for (std::size_t at = 0, end; at <= wrong.size(); at = end + 1) {
    end = std::min(wrong.find('-', at), wrong.size());
    words.push_back(wrong.substr(at, end - at));
  }
  std::vector<std::string> close = known;
  const std::string nearest = nearest_name(wrong, known);
  const auto distance = [&](const std::string& name) {
    return name == nearest ? -std::ssize(words) - 1
                           : -std::ranges::count_if(words, [&](const std::string& word) {
                               return ("-" + name + "-").find("-" + word + "-") < name.size() + 2;
                             });
  };
  std::ranges::stable_sort(close, {}, distance);
  std::erase_if(close, [&](const std::string& name) { return distance(name) == 0; });
  close.resize(std::min(close.size(), kMost));
  std::string guess;
  for (const std::string& name : close)
    guess += fmt::format("{} '{}'", guess.empty() ? "did you mean" : ",", name);
  return fmt::format("unknown claim '{}'; {}{}`isoline claims --list --all` lists all claims",
                     wrong, guess, guess.empty() ? "" : "? ");
}

}  // namespace

std::vector<Claim> chosen_claims(std::vector<Claim> claims, const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const Claim& claim : claims) {
    known.push_back(claim.id);
    if (std::ranges::find(known, claim.group) == known.end()) known.push_back(claim.group);
  }
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end()) throw UsageError(unknown_claim(name, known));
  std::erase_if(claims, [&](const Claim& claim) {
    return !names.empty() && std::ranges::find(names, claim.id) == names.end() &&
           std::ranges::find(names, claim.group) == names.end();
  });
  return claims;
}

std::vector<Request> cells_of(const std::vector<Claim>& claims, bool with_long) {
  std::vector<Request> requests;
  std::set<std::string> known;
  for (const Claim& claim : claims)
    for (const Claim::Cells& cells : claim.cells) {
      if (cells.is_long && !with_long) continue;
      for (const Request& request : cells.requests)
        if (known.insert(request.cell).second) requests.push_back(request);
    }
  return requests;
}

Json json_of(const std::vector<Claim>& claims) {
  Json list = Json::array();
  for (const Claim& claim : claims) list.push_back(*claim.json);
  return list;
}

std::vector<Record> published_records(const Catalog& catalog) {
  std::vector<Record> records;
  for (const auto& [name, text] : builtin_published()) {
    Request& asked = records.emplace_back(record_from_text(std::string(text), name)).request;
    asked.problem = complete_problem(catalog, asked.problem.name, asked.problem.options);
    asked.optimizer = complete_optimizer(catalog, asked.optimizer.name, asked.optimizer.options);
  }
  return records;
}

}  // namespace isoline::benchmarks
