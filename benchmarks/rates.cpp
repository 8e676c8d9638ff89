// Tables of rates: reading, looking up, joining.
#include "benchmarks/rates.h"

#include <fmt/format.h>

#include "benchmarks/resources.h"
#include "core/errors.h"
#include "core/json.h"

namespace isoline {

Rates Rates::builtin() {
  Rates all;
  for (const auto& [name, text] : builtin_rates())
    all.add(from_json(parse_json(std::string(text), name), name + ".json"));
  return all;
}

Rates Rates::from_json(const Json& json, const std::string& origin) {
  Rates rates;
  try {
    for (const Json& row : json.at("rows"))
      rates.rows_[{row.at("problem"), row.at("optimizer")}] = {row.at("options"), origin};
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("{} is no table of rates: {}", origin, error.what()));
  }
  return rates;
}

const Rates::Row* Rates::find(const std::string& problem_spec, const std::string& optimizer) const {
  const auto row = rows_.find({problem_spec, optimizer});
  return row == rows_.end() ? nullptr : &row->second;
}

void Rates::add(const Rates& other) {
  for (const auto& [pair, row] : other.rows_) rows_[pair] = row;
}

}  // namespace isoline
