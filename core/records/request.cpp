// Conversion of requests to and from JSON, and the digest that names a cell.
#include "core/records/request.h"

#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/json.h"
#include "core/learning_options.h"
#include "core/options.h"
#include "core/records/record_fields.h"

namespace isoline {

bool asks_to_learn(const OptionValues& options) { return options.text(kModeOption) == kLearnMode; }

bool is_instance_of(OptionValues direct, OptionValues learned) {
  if (asks_to_learn(direct) || !asks_to_learn(learned)) return false;
  for (const char* of_learning : kLearningOptions) {
    direct.erase(of_learning);
    learned.erase(of_learning);
  }
  return direct == learned;
}

// A JSON object with its keys in order.
CellNames::CellNames(const Request& request) {
  Json budget;
  Form<Budget>::write(request.budget, JsonPlace(budget));
  const Json shared{{"budget", std::move(budget)},
                    {"optimizer", request.optimizer.name},
                    {"optimizer_options", to_json(without_empty(request.optimizer.options))},
                    {"problem", request.problem.name},
                    {"problem_options", to_json(without_empty(request.problem.options))}};
  before_ = json_text(shared);
  before_.pop_back();  // its brace
  before_ += ",\"seed\":";
  after_ = ",\"threads\":" + std::to_string(request.threads) + "}";
}

std::string CellNames::of(std::uint64_t seed) const {
  return digest(before_ + std::to_string(seed) + after_);
}

RatesKind kind_of_rates(const std::string& file) {
  if (file.empty()) return RatesKind::none;
  return file.ends_with("-tuned.json") ? RatesKind::tuned : RatesKind::published;
}

std::string cell_digest(const Request& request) { return CellNames(request).of(request.seed); }

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
