// Requests to JSON and back, and the digest that names a cell.
#include "core/records/request.h"

#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/json.h"
#include "core/option_json.h"
#include "core/records/request_fields.h"

namespace isoline {

bool asks_to_learn(const OptionValues& options) { return options.text("mode") == "learn"; }

std::string cell_digest(const Request& request) {
  Json budget;
  Form<Budget>::write(request.budget, JsonPlace(budget));
  const Json asked{{"problem", request.problem.name},
                   {"problem_options", to_json(request.problem.options)},
                   {"optimizer", request.optimizer.name},
                   {"optimizer_options", to_json(request.optimizer.options)},
                   {"seed", request.seed},
                   {"budget", std::move(budget)},
                   {"threads", request.threads}};
  return digest(json_text(asked));
}

Request named(Request request) {
  request.cell = cell_digest(request);
  return request;
}

Json to_json(const Request& request) {
  Json json;
  Form<Request>::write(request, JsonPlace(json));
  return json;
}

Request request_from_json(const Json& json) {
  JsonReader reader;
  Request request;
  Form<Request>::read(reader.parse(json_text(json), "a request"), request);
  return named(std::move(request));
}

}  // namespace isoline
