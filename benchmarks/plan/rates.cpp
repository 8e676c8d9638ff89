// Reads, looks up and joins tables of rates and of best losses.
#include "benchmarks/plan/rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/suite.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/options.h"
#include "core/records/json_view.h"
#include "core/seeds.h"
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
  return option_text(value) == wanted;
}

// Whether a problem's complete options have the values that a row names, as text.
bool is_for(const OptionValues& row, const OptionValues& complete) {
  return std::ranges::all_of(row, [&](const NamedOption& wanted) {
    const OptionValue* value = complete.find(wanted.name);
    return value && is_same(*value, option_text(wanted.value));
  });
}

}  // namespace

Rates Rates::builtin() {
  Rates all;
  for (const auto& [name, text] : builtin_rates())
    all.add(from_text(std::string(text), name + ".json"));
  return all;
}

Rates Rates::named(const std::string& given) {
  if (given == "builtin") return builtin();
  if (given == "none") return {};
  const std::string text = read_text(given);
  require_valid(parse_json(text, given), "rates", given);
  return from_text(text, given);
}

Rates Rates::from_text(const std::string& text, const std::string& origin) {
  Rates rates;
  JsonReader reader;
  const JsonView json = reader.parse(text, origin);
  try {
    for (const JsonView& row : json.at("rows").values()) {
      const std::string setting = row.at("problem");
      const Spec problem = parse_spec(setting);
      const bool has_source = row.contains("source");
      rates.rows_[{problem.name, row.at("optimizer").get<std::string>()}].push_back(
          {options_of(problem), option_values_from(row.at("options").json()), setting, origin,
           has_source ? row.at("source").text() : "{}",
           has_source && row.at("source").contains("grid")});
    }
  } catch (const std::exception& error) {
    throw UsageError(fmt::format("{} is not a table of rates: {}", origin, reason_of(error)));
  }
  return rates;
}

bool Rates::Row::names_all_of(const Component& asked) const {
  return std::ranges::all_of(options_of(parse_spec(asked.spec)), [&](const NamedOption& option) {
    return problem.contains(option.name);
  });
}

const Rates::Row* Rates::find(const Component& problem, const std::string& optimizer,
                              const std::string& table) const {
  const auto rows = rows_.find({problem.name, optimizer});
  if (rows == rows_.end()) return nullptr;
  const bool is_in_other_mode = options_of(parse_spec(problem.spec)).contains(kModeOption);
  const Row* best = nullptr;
  for (const Row& row : rows->second) {
    if (is_in_other_mode && !row.problem.contains(kModeOption)) continue;
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

// Best losses: read, looked up, renewed.

namespace {

BestLosses& known_losses() {
  static BestLosses all =
      BestLosses::from_json(parse_json(std::string(embedded_best()), "best.json"), "best.json");
  return all;
}

}  // namespace

const BestLosses& BestLosses::known() { return known_losses(); }

void BestLosses::add_known(const std::string& path) {
  std::vector<Row>& rows = known_losses().rows_;
  const BestLosses table = from_json(read_json(path), path);
  for (const Row& added : table.rows_) {
    const auto row = std::ranges::find_if(rows, [&](const Row& each) {
      return each.problem == added.problem && each.options == added.options;
    });
    if (row == rows.end())
      rows.push_back(added);
    else
      for (const auto& [seed, loss] : added.losses)
        if (const auto [at, is_new] = row->losses.try_emplace(seed, loss);
            !is_new && loss.loss < at->second.loss)
          at->second = loss;
  }
}

BestLosses BestLosses::from_json(const Json& json, const std::string& origin) {
  require_valid(json, "best", origin);
  BestLosses best;
  for (const Json& row : json.at("rows")) {
    Row& read = best.rows_.emplace_back();
    read.problem = row.at("problem");
    try {
      read.options = option_values_from(row.at("options"));
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("{}: {}", origin, error.what()));
    }
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
  return {{"schema", "isoline.best/1"}, {"rows", rows}};
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
  const auto known = rows_[place].losses.find(instance_of(seed));
  return known == rows_[place].losses.end() ? std::nullopt : std::optional(known->second.loss);
}

std::string BestLosses::losses_text(const Component& problem) const {
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
  const auto [known, is_new] = rows_[place].losses.try_emplace(instance_of(record.request.seed));
  if (!is_new && known->second.loss <= loss) return false;
  known->second = {loss, record.request.optimizer.spec};
  return true;
}

}  // namespace isoline::benchmarks
