// A comparison as JSON, schema isoline.comparison/1.
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/compare/gate_words.h"

namespace isoline::reports {
namespace {

Json json_of(const Difference& d) {
  return {{"change", name_of(d.change)},
          {"cell", d.key},
          {"title", d.title},
          {"optimizer", d.optimizer},
          {"figure", d.what},
          {"before", d.before},
          {"after", d.after},
          {"relative", json_number(d.relative)},
          {"note", d.note},
          {"problem", d.problem},
          {"cause", d.cause},
          {"rounding", d.is_rounding}};
}

Json json_of(const TimeVerdict& t) {
  return {{"change", name_of_time(t.change)},
          {"cell", t.key},
          {"title", t.title},
          {"n", {t.n_before, t.n_after}},
          {"ratio", json_number(t.ratio.ratio)},
          {"low", json_number(t.ratio.low)},
          {"high", json_number(t.ratio.high)},
          {"p", t.p},
          {"adjusted_p", t.adjusted},
          {"noise", json_number(t.noise)}};
}

Json json_of(const DifferenceGroup& g) {
  Json problems = Json::object();
  for (const auto& [name, cells] : g.problems) problems[name] = cells.size();
  return {{"change", name_of(g.change)}, {"cause", g.cause},      {"optimizer", g.optimizer},
          {"problems", problems},        {"cells", g.cells},      {"of", g.of},
          {"figures", g.what},           {"worst", g.worst.title}};
}

Json json_of(const CauseGroup& group) {
  return {{"cause", group.cause},
          {"cells", group.cells.size()},
          {"optimizers", group.optimizers},
          {"problems", group.problems},
          {"worse", group.worse.size()},
          {"better", group.better.size()},
          {"changed", group.changed.size()},
          {"rounding", group.rounded()},
          {"not_comparable", group.incomparable}};
}

Json json_of(const OtherTerms& terms) {
  return {{"what", terms.what}, {"cells", terms.cells}, {"optimizers", terms.optimizers}};
}

Json json_of(const AllowedCell& cell) { return {{"title", cell.title}, {"reason", cell.reason}}; }

Json json_of(const Incomparable& one) { return {{"title", one.title}, {"reason", one.reason}}; }

template <class Value>
Json list_of(const std::vector<Value>& values) {
  Json list = Json::array();
  for (const Value& value : values) list.push_back(json_of(value));
  return list;
}

}  // namespace

std::string gate_json(const GateResult& result) {
  const Json json{{"schema", kComparisonSchema},
                  {"verdict", result.verdict},
                  {"exit_code", static_cast<int>(result.exit_code)},
                  {"joined", result.joined},
                  {"equal", result.equal},
                  {"chaotic", result.chaotic},
                  {"builds", result.builds},
                  {"options", result.settings},
                  {"differences", list_of(result.differences)},
                  {"causes", list_of(result.causes)},
                  {"other_budgets", list_of(result.otherwise)},
                  {"groups", list_of(result.groups)},
                  {"times", list_of(result.times)},
                  {"not_comparable", list_of(result.incomparable)},
                  {"only_in_base", result.only_before},
                  {"allowed", list_of(result.allowed)},
                  {"only_in_new", result.only_after},
                  {"remarks", result.remarks}};
  return json_text(json, 1) + "\n";
}

}  // namespace isoline::reports
