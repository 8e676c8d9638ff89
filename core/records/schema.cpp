// JSON Schema by valijson, the only door to it.
#include "core/records/schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace isoline {

using Adapter = valijson::adapters::NlohmannJsonAdapter;

struct Schema::Parsed {
  valijson::Schema schema;
};

Schema::Schema(const Json& schema) {
  auto parsed = std::make_unique<Parsed>();
  valijson::SchemaParser().populateSchema(Adapter(schema), parsed->schema);
  parsed_ = std::move(parsed);
}

Schema::~Schema() = default;

std::vector<std::string> Schema::violations(const Json& document) const {
  valijson::ValidationResults results;
  valijson::Validator().validate(parsed_->schema, Adapter(document), &results);
  std::vector<std::string> violations;
  for (valijson::ValidationResults::Error error; results.popError(error);)
    violations.push_back(fmt::format("{}: {}", fmt::join(error.context, ""), error.description));
  return violations;
}

std::vector<std::string> schema_violations(const Json& document, const Json& schema) {
  return Schema(schema).violations(document);
}

}  // namespace isoline
