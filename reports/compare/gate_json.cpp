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
          {"figure", d.what},
          {"before", d.before},
          {"after", d.after},
          {"relative", json_number(d.relative)},
          {"note", d.note}};
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

}  // namespace

std::string gate_json(const GateResult& result) {
  Json differences = Json::array(), times = Json::array(), incomparable = Json::array();
  for (const Difference& difference : result.differences)
    differences.push_back(json_of(difference));
  for (const TimeVerdict& time : result.times) times.push_back(json_of(time));
  for (const Incomparable& one : result.incomparable)
    incomparable.push_back({{"title", one.title}, {"reason", one.reason}});
  const Json json{{"schema", kComparisonSchema},
                  {"verdict", result.verdict},
                  {"exit_code", result.exit_code},
                  {"joined", result.joined},
                  {"equal", result.equal},
                  {"chaotic", result.chaotic},
                  {"differences", differences},
                  {"times", times},
                  {"not_comparable", incomparable},
                  {"only_in_base", result.only_before},
                  {"only_in_new", result.only_after},
                  {"remarks", result.remarks}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace isoline::reports
