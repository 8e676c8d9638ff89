// Requests to JSON and back, and the digest that names a cell.
#include "core/json.h"
#include "core/records/record.h"

namespace isoline {
namespace {

Json to_json(const Component& component) {
  return {{"name", component.name},
          {"options", component.options},
          {"spec", component.spec},
          {"revision", component.revision}};
}

Component component_from(const Json& json) {
  return {json.at("name"), json.at("options"), json.at("spec"), json.at("revision")};
}

Json to_json(const Budget& budget) {
  Json json{{"iterations", budget.iterations},
            {"target", json_number(budget.target)},
            {"seconds", json_number(budget.seconds)}};
  const bool is_bounded = budget.work < std::numeric_limits<std::int64_t>::max();
  json["work"] = is_bounded ? Json(budget.work) : Json(nullptr);
  return json;
}

Budget budget_from(const Json& json) {
  Budget budget{.iterations = json.at("iterations"),
                .seconds = real_of(json.at("seconds")),
                .target = real_of(json.at("target"))};
  if (!json.at("work").is_null()) budget.work = json.at("work");
  return budget;
}

}  // namespace

Json to_json(const Request& request) {
  return {{"problem", to_json(request.problem)},
          {"optimizer", to_json(request.optimizer)},
          {"seed", request.seed},
          {"budget", to_json(request.budget)},
          {"threads", request.threads},
          {"rates", request.rates}};
}

Request request_from_json(const Json& json) {
  return {.problem = component_from(json.at("problem")),
          .optimizer = component_from(json.at("optimizer")),
          .seed = json.at("seed"),
          .budget = budget_from(json.at("budget")),
          .threads = json.at("threads"),
          .rates = json.at("rates")};
}

std::string cell_digest(const Request& request) {
  const Json asked{{"problem", request.problem.name},
                   {"problem_options", request.problem.options},
                   {"optimizer", request.optimizer.name},
                   {"optimizer_options", request.optimizer.options},
                   {"seed", request.seed},
                   {"budget", to_json(request.budget)},
                   {"threads", request.threads}};
  return digest(asked.dump());
}

}  // namespace isoline
