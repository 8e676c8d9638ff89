// Joins records and plans. Each part takes the greater of the two in some total order, or their
// union: both are joins of a lattice, hence the laws.
#include "benchmarks/merge/join.h"

#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "core/json.h"
#include "core/records/record.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

bool is_nondeterministic(const Json& record) { return record.at("nondeterministic").get<bool>(); }

Json build_provenance(const Json& record) {
  Json provenance = record.at("provenance");
  provenance.erase("run");
  return provenance;
}

// Runs that ended by themselves before those that a clock ended, then the latest; the text decides
// what is left. The list of timings is joined apart.
auto rank_of(const Json& record) {
  Json rest = record;
  rest.erase("repeat_wall_seconds");
  rest.erase("fields");
  rest.erase("spectrum");
  const Json run = record.at("provenance").value("run", Json::object());
  return std::tuple(!is_nondeterministic(record),
                    run.is_object() ? run.value("started", std::string()) : std::string(),
                    json_text(rest));
}

// Sorted; a value as often as in the list that has it most often.
Json joined_timings(const Json& a, const Json& b) {
  std::vector<Real> left = reals_of(a), right = reals_of(b), both;
  const auto is_less = [](Real x, Real y) { return std::strong_order(x, y) < 0; };  // nan last
  std::ranges::sort(left, is_less);
  std::ranges::sort(right, is_less);
  std::ranges::set_union(left, right, std::back_inserter(both), is_less);
  return json_numbers(both);
}

std::string shown(const Json& value) {
  constexpr std::size_t kMost = 60;
  const std::string text = json_text(value);
  return text.size() > kMost ? std::string(cut(text, kMost)) + "…" : text;
}

// "/summary/loss (1.5, 1.6), /status (…), and 3 more places".
std::string first_differences(const Json& a, const Json& b) {
  constexpr std::size_t kTold = 3;
  const Json patch = Json::diff(a, b);
  std::string text;
  for (std::size_t i = 0; i < std::min(patch.size(), kTold); ++i) {
    const Json::json_pointer place(patch[i].at("path").get<std::string>());
    const auto at = [&](const Json& json) {
      return json.contains(place) ? shown(json.at(place)) : std::string("absent");
    };
    text += fmt::format("{}{} ({}, {})", i == 0 ? "" : ", ", place.to_string(), at(a), at(b));
  }
  if (patch.size() > kTold) text += fmt::format(", and {} more places", patch.size() - kTold);
  return text;
}

}  // namespace

JoinedRecord join_records(const Json& a, const Json& b) {
  const Json left = result_of(a), right = result_of(b);
  const bool is_same = left == right;
  if (!is_same && !is_nondeterministic(a) && !is_nondeterministic(b))
    return {nullptr, first_differences(left, right), false};
  const bool is_b = rank_of(a) < rank_of(b);
  Json joined = is_b ? b : a;
  const Json& other = is_b ? a : b;
  for (const char* asked : {"fields", "spectrum"})  // one was asked for them and the other was not
    if (is_same && other.contains(asked) && !joined.contains(asked))
      joined[asked] = other.at(asked);
  joined["repeat_wall_seconds"] =
      joined_timings(a.at("repeat_wall_seconds"), b.at("repeat_wall_seconds"));
  return {std::make_shared<const Json>(std::move(joined)), "",
          build_provenance(a) != build_provenance(b)};
}

Plan join_plans(const Plan& a, const Plan& b) {
  using Place = std::tuple<std::string, std::string, std::uint64_t>;
  std::set<std::string> suites;
  std::map<std::string, Place> place;  // by cell; the least where a digest has two
  for (const Plan* plan : {&a, &b}) {
    suites.insert(plan->suites.begin(), plan->suites.end());
    for (const PlannedCell& cell : plan->cells) {
      const Place here(cell.problem, cell.optimizer, cell.seed);
      const auto [at, is_first] = place.emplace(cell.cell, here);
      if (!is_first) at->second = std::min(at->second, here);
    }
  }
  std::set<std::pair<Place, std::string>> sorted;
  for (const auto& [cell, where] : place) sorted.emplace(where, cell);
  Plan plan{.suites = {suites.begin(), suites.end()}, .cells = {}};
  for (const auto& [where, cell] : sorted)
    plan.cells.push_back({cell, std::get<0>(where), std::get<1>(where), std::get<2>(where)});
  return plan;
}

Json join_rates(const Json& a, const Json& b) {
  std::map<std::pair<std::string, std::string>, Json> rows;  // by problem and optimizer
  for (const Json* one : {&a, &b})
    for (const Json& row : one->at("rows")) {
      const auto [at, is_first] = rows.try_emplace({row.at("problem"), row.at("optimizer")}, row);
      if (!is_first && json_text(row) < json_text(at->second)) at->second = row;
    }
  Json all = Json::array();
  for (const auto& [pair, row] : rows) all.push_back(row);
  return {{"schema", "isoline.rates/1"}, {"rows", all}};
}

bool have_other_wordings(const std::vector<std::string>& sheets) {
  std::set<std::string> wordings;
  for (const std::string& text : sheets) {
    Json sheet = Json::parse(text, nullptr, false);
    if (sheet.is_object()) sheet.erase("prices");
    wordings.insert(sheet.is_object() ? json_text(sheet) : text);
  }
  return wordings.size() > 1;
}

}  // namespace isoline::benchmarks
