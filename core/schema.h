// JSON Schema: does a document have the form it claims?
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isoline {

using Json = nlohmann::json;

// What is wrong with the document, one sentence each, its place first; empty if it conforms.
std::vector<std::string> schema_violations(const Json& document, const Json& schema);

}  // namespace isoline
