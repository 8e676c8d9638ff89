// Best losses: read, looked up, renewed.
#include "benchmarks/plan/best.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/catalog.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/options.h"
#include "core/records/schema.h"

namespace isoline::benchmarks {
namespace {

constexpr const char* kSchema = "isoline.best/1";

}  // namespace

const BestLosses& BestLosses::builtin() {
  static const BestLosses all =
      from_json(parse_json(std::string(embedded_best()), "best.json"), "best.json");
  return all;
}

BestLosses BestLosses::from_json(const Json& json, const std::string& origin) {
  const Json schema = parse_json(std::string(builtin_schemas().at("best")), "best schema");
  const auto violations = schema_violations(json, schema);
  require(violations.empty(),
          [&] { return origin + " is no table of best losses: " + violations[0]; });
  BestLosses best;
  for (const Json& row : json.at("rows")) {
    Row& read = best.rows_.emplace_back();
    read.problem = row.at("problem");
    read.options = option_values_from(row.at("options"));
    for (const Json& one : row.at("losses"))
      read.losses[one.at("seed")] = {real_of(one.at("loss")), one.at("optimizer")};
  }
  return best;
}

Json BestLosses::to_json() const {
  Json rows = Json::array();
  for (const Row& row : rows_) {
    Json losses = Json::array();
    for (const auto& [seed, known] : row.losses)
      losses.push_back({{"seed", seed}, {"loss", known.loss}, {"optimizer", known.optimizer}});
    rows.push_back(
        {{"problem", row.problem}, {"options", isoline::to_json(row.options)}, {"losses", losses}});
  }
  return {{"schema", kSchema}, {"rows", rows}};
}

std::size_t BestLosses::place_of(const Component& problem) const {
  const OptionValues named = without_empty(problem.options);
  const auto row = std::ranges::find_if(rows_, [&](const Row& each) {
    return each.problem == problem.name && each.options == named;
  });
  return static_cast<std::size_t>(row - rows_.begin());
}

std::optional<Real> BestLosses::find(const Component& problem, std::uint64_t seed) const {
  const std::size_t place = place_of(problem);
  if (place == rows_.size()) return std::nullopt;
  const auto known = rows_[place].losses.find(seed);
  return known == rows_[place].losses.end() ? std::nullopt : std::optional(known->second.loss);
}

std::string BestLosses::text_of(const Component& problem) const {
  const std::size_t place = place_of(problem);
  if (place == rows_.size()) return "";
  Json losses = Json::object();
  for (const auto& [seed, known] : rows_[place].losses) losses[std::to_string(seed)] = known.loss;
  return json_text(losses);
}

bool BestLosses::add(const Record& record) {
  const Real loss = record.summary.best_loss;
  if (record.imported || !std::isfinite(loss) || record.status == Status::inapplicable)
    return false;
  const Component& problem = record.request.problem;
  const std::size_t place = place_of(problem);
  if (place == rows_.size()) rows_.push_back({problem.name, without_empty(problem.options), {}});
  const auto [known, is_new] = rows_[place].losses.try_emplace(record.request.seed);
  if (!is_new && known->second.loss <= loss) return false;
  known->second = {loss, record.request.optimizer.spec};
  return true;
}

}  // namespace isoline::benchmarks
