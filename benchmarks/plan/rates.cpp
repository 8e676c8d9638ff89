// Tables of rates: reading, looking up, joining.
#include "benchmarks/plan/rates.h"

#include <fmt/format.h>

#include <cstdlib>

#include "benchmarks/plan/resources.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/spec.h"

namespace isoline::benchmarks {
namespace {

bool is_in(const std::string& table, const std::string& origin) {
  return table.empty() ? !origin.ends_with("-tuned.json") : origin == table + ".json";
}

// Whether a problem's complete options have the values that a row names, as text.
bool is_for(const Json& row, const Component& problem) {
  const Json& complete = problem.options;
  const bool is_other_mode = problem.spec.find("mode=") != std::string::npos;
  if (!row.contains("mode") && is_other_mode) return false;
  for (const auto& [key, wanted] : row.items()) {
    if (!complete.contains(key)) return false;
    const Json& value = complete[key];
    const auto text = wanted.get<std::string>();
    const bool is_same = value.is_number() ? value.get<Real>() == std::strtod(text.c_str(), nullptr)
                                           : value == Json(text);
    if (!is_same) return false;
  }
  return true;
}

}  // namespace

Rates Rates::builtin() {
  Rates all;
  for (const auto& [name, text] : builtin_rates())
    all.add(from_json(parse_json(std::string(text), name), name + ".json"));
  return all;
}

Rates Rates::from_json(const Json& json, const std::string& origin) {
  Rates rates;
  try {
    for (const Json& row : json.at("rows")) {
      const Spec problem = parse_spec(row.at("problem").get<std::string>());
      rates.rows_[{problem.name, row.at("optimizer")}].push_back(
          {options_of(problem), row.at("options"), origin});
    }
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("{} is no table of rates: {}", origin, error.what()));
  }
  return rates;
}

const Rates::Row* Rates::find(const Component& problem, const std::string& optimizer,
                              const std::string& table) const {
  const auto rows = rows_.find({problem.name, optimizer});
  if (rows == rows_.end()) return nullptr;
  const Row* best = nullptr;
  for (const Row& row : rows->second)
    if (is_in(table, row.origin) && is_for(row.problem, problem) &&
        (!best || row.problem.size() >= best->problem.size()))
      best = &row;
  return best;
}

void Rates::add(const Rates& other) {
  for (const auto& [pair, rows] : other.rows_)
    rows_[pair].insert(rows_[pair].end(), rows.begin(), rows.end());
}

}  // namespace isoline::benchmarks
