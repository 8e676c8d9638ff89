// An audit to JSON and back.
#include "core/records/audited.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"

namespace isoline {
namespace {

constexpr const char* kSchema = "isoline.audit/1";

Json to_json(const PowerLaw& law) {
  return {{"values", json_numbers(law.values)},
          {"exponent", json_number(law.exponent)},
          {"residual", json_number(law.residual)},
          {"holds", law.holds()}};
}

PowerLaw power_law_from(const Json& json) {
  return {reals_of(json.at("values")), real_of(json.at("exponent")), real_of(json.at("residual"))};
}

Json to_json(const Approach& approach) {
  return {{"order", json_number(approach.order)},
          {"residual", json_number(approach.residual)},
          {"remaining", json_number(approach.remaining)},
          {"steps", approach.steps},
          {"is_exact", approach.is_exact}};
}

Approach approach_from(const Json& json) {
  return {.order = real_of(json.at("order")),
          .residual = real_of(json.at("residual")),
          .remaining = real_of(json.at("remaining")),
          .steps = json.at("steps"),
          .is_exact = json.at("is_exact")};
}

void read_measurements(const Json& json, AuditedOptimizer& audited) {
  audited.network = json.value("network", "");
  for (std::size_t i = 0; i < kScalingNames.size(); ++i) {
    const Json& law = json.at("scalings").at(std::string(kScalingNames[i]));
    audited.scalings[i] = {reals_of(law.at("scales")), power_law_from(law.at("step")),
                           power_law_from(law.at("loss_change"))};
  }
  for (std::size_t i = 0; i < kChangeNames.size(); ++i)
    audited.deviations[i] = real_of(json.at("invariance").at(std::string(kChangeNames[i])));
  audited.regular = approach_from(json.at("convergence").at("regular"));
  audited.singular = approach_from(json.at("convergence").at("singular"));
  audited.linear_angle = real_of(json.at("composition").at("linear"));
  audited.curved_angle = real_of(json.at("composition").at("curved"));
  audited.declared = json.at("oracles").at("declared").get<std::vector<std::string>>();
  audited.counted = json.at("oracles").at("counted").get<std::map<std::string, std::int64_t>>();
  audited.iterations = json.at("oracles").at("iterations");
  audited.flags = json.at("flags").get<std::vector<std::string>>();
}

}  // namespace

bool PowerLaw::has_values() const {
  return std::ranges::any_of(values, [](Real value) { return std::isfinite(value); });
}

Json to_json(const AuditedOptimizer& audited) {
  Json json{{"name", audited.name}, {"spec", audited.spec}, {"reason", audited.reason}};
  if (!audited.reason.empty()) return json;
  if (!audited.network.empty()) json["network"] = audited.network;
  for (std::size_t i = 0; i < kScalingNames.size(); ++i) {
    const ScalingLaw& law = audited.scalings[i];
    json["scalings"][std::string(kScalingNames[i])] = {{"scales", json_numbers(law.scales)},
                                                       {"step", to_json(law.step)},
                                                       {"loss_change", to_json(law.loss_change)}};
  }
  for (std::size_t i = 0; i < kChangeNames.size(); ++i)
    json["invariance"][std::string(kChangeNames[i])] = json_number(audited.deviations[i]);
  json["convergence"] = {{"regular", to_json(audited.regular)},
                         {"singular", to_json(audited.singular)}};
  json["composition"] = {{"linear", json_number(audited.linear_angle)},
                         {"curved", json_number(audited.curved_angle)}};
  json["oracles"] = {{"declared", audited.declared},
                     {"counted", audited.counted},
                     {"iterations", audited.iterations}};
  json["flags"] = audited.flags;
  return json;
}

AuditedOptimizer audited_from_json(const Json& json) {
  AuditedOptimizer audited{
      .name = json.at("name"), .spec = json.at("spec"), .reason = json.at("reason")};
  if (audited.reason.empty()) read_measurements(json, audited);
  return audited;
}

Json audit_to_json(const std::vector<AuditedOptimizer>& all) {
  Json json{{"schema", kSchema}, {"optimizers", Json::array()}};
  for (const AuditedOptimizer& audited : all) json["optimizers"].push_back(to_json(audited));
  return json;
}

std::vector<AuditedOptimizer> audit_from_json(const Json& json) {
  try {
    require(json.at("schema") == kSchema, "the schema is not isoline.audit/1");
    std::vector<AuditedOptimizer> all;
    for (const Json& audited : json.at("optimizers")) all.push_back(audited_from_json(audited));
    return all;
  } catch (const Json::exception& error) {
    throw UsageError(std::string("no audit: ") + error.what());
  }
}

}  // namespace isoline
