// JSON Schema by valijson; the only adapter to it.
#include "core/records/schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <limits>
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
namespace {

// valijson reads integers as signed ones: beyond them a seed would be below zero.
bool is_beyond(const Json& value) {
  return value.is_number_unsigned() &&
         value.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max();
}
bool holds_beyond(const Json& value) {
  if (value.is_structured()) return std::ranges::any_of(value, holds_beyond);
  return is_beyond(value);
}

// Larger numbers are replaced by the largest that it reads.
void bring_within(Json& value) {
  if (value.is_structured())
    for (Json& each : value) bring_within(each);
  else if (is_beyond(value))
    value = std::numeric_limits<std::int64_t>::max();
}

}  // namespace

Schema::Schema(const Json& schema) {
  auto parsed = std::make_unique<Parsed>();
  valijson::SchemaParser().populateSchema(Adapter(schema), parsed->schema);
  parsed_ = std::move(parsed);
}

Schema::~Schema() = default;

std::vector<std::string> Schema::violations(const Json& document) const {
  if (holds_beyond(document)) {
    Json within = document;
    bring_within(within);
    return violations(within);
  }
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
