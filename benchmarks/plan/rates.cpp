// Tables of rates: reading, looking up, joining.
#include "benchmarks/plan/rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/catalog.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/options.h"
#include "core/spec.h"

namespace isoline::benchmarks {
namespace {

bool is_in(const std::string& table, const std::string& origin) {
  return table.empty() ? kind_of_rates(origin) != RatesKind::tuned : origin == table + ".json";
}

bool is_same(const OptionValue& value, const std::string& wanted) {
  const auto as_number = [&](Real number) {
    return number == std::strtod(wanted.c_str(), nullptr);
  };
  if (const Real* number = std::get_if<Real>(&value)) return as_number(*number);
  if (const Index* number = std::get_if<Index>(&value))
    return as_number(static_cast<Real>(*number));
  return text_of(value) == wanted;
}

// Whether a problem's complete options have the values that a row names, as text.
bool is_for(const OptionValues& row, const OptionValues& complete) {
  return std::ranges::all_of(row, [&](const NamedOption& wanted) {
    const OptionValue* value = complete.find(wanted.name);
    return value && is_same(*value, text_of(wanted.value));
  });
}

}  // namespace

Rates Rates::builtin() {
  Rates all;
  for (const auto& [name, text] : builtin_rates())
    all.add(from_json(parse_json(std::string(text), name), name + ".json"));
  return all;
}

Rates Rates::named(const std::string& given) {
  if (given == "builtin") return builtin();
  if (given == "none") return {};
  return from_json(read_json(given), given);
}

Rates Rates::from_json(const Json& json, const std::string& origin) {
  Rates rates;
  try {
    for (const Json& row : json.at("rows")) {
      const Spec problem = parse_spec(row.at("problem").get<std::string>());
      rates.rows_[{problem.name, row.at("optimizer")}].push_back(
          {options_of(problem), option_values_from(row.at("options")), origin,
           json_text(row.value("source", Json::object())),
           row.contains("source") && row["source"].contains("grid")});
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
  const bool is_in_other_mode = options_of(parse_spec(problem.spec)).contains("mode");
  const Row* best = nullptr;
  for (const Row& row : rows->second) {
    if (is_in_other_mode && !row.problem.contains("mode")) continue;
    if (is_in(table, row.origin) && is_for(row.problem, problem.options) &&
        (!best || row.problem.size() >= best->problem.size()))
      best = &row;
  }
  return best;
}

void Rates::add(const Rates& other) {
  for (const auto& [pair, rows] : other.rows_)
    rows_[pair].insert(rows_[pair].end(), rows.begin(), rows.end());
}

}  // namespace isoline::benchmarks
