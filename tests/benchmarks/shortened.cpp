// Claims cut down before their cells are expanded.
#include "tests/benchmarks/shortened.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "tests/benchmarks/builtin.h"

namespace isoline::benchmarks {
namespace {

void shorten(Json& asked, std::int64_t most) {
  Json& quantity = asked["quantity"];
  const auto cut = [&](Json& place) {
    if (place.contains("iteration"))
      place["iteration"] = std::min(most, place["iteration"].get<std::int64_t>());
  };
  cut(quantity);
  for (Json& term : quantity["terms"]) cut(term);
}

// The claims of the tree, as if they spoke of no more than so many iterations: of each the
// cheapest of its sets of cells, over so many seeds where it is over any.
std::vector<Claim> shortened(std::int64_t most, int seeds) {
  std::vector<Claim> all;
  for (const auto& [name, text] : builtin_claims()) {
    Json file = parse_json(std::string(text), name);
    for (Json& claim : file["claims"]) {
      if (claim.contains("not_comparable") || claim.contains("undecidable"))  // no run decides it
        for (const char* part : {"cells", "quantity", "contrasts"}) claim.erase(part);
      if (!claim.contains("cells")) continue;
      Json cheapest = claim["cells"].back();
      Json& iterations = cheapest["budget"]["iterations"];
      iterations = std::min(most, iterations.get<std::int64_t>());
      if (cheapest.contains("seeds")) cheapest["seeds"] = std::to_string(seeds);
      claim["cells"] = Json::array({cheapest});
      claim.erase("length");
      shorten(claim, most);
      if (claim.contains("contrasts"))
        for (Json& contrast : claim["contrasts"]) shorten(contrast, most);
    }
    for (Claim& claim : claims_from_json(catalog(), Rates::builtin(), file, name))
      if (!claim.cells.empty()) all.push_back(std::move(claim));
  }
  return all;
}

// Whether a cell of a claim is of one of these kinds, by what its specs say.
bool has(const Claim& claim, const std::vector<std::string>& parts) {
  return std::ranges::any_of(claim.cells.back().requests, [&](const Request& request) {
    const std::string spec = request.problem.spec + " " + request.optimizer.spec;
    return std::ranges::any_of(
        parts, [&](const std::string& part) { return spec.find(part) != std::string::npos; });
  });
}

}  // namespace

std::vector<Claim> claims_without(const std::vector<std::string>& dear, std::int64_t most,
                                  int seeds) {
  std::vector<Claim> all = shortened(most, seeds);
  std::erase_if(all, [&](const Claim& claim) { return has(claim, dear); });
  return all;
}

}  // namespace isoline::benchmarks
