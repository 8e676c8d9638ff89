// JSON Schema: does a document have the form it claims?
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isoline {

using Json = nlohmann::json;

// Read once, for documents by the hundred thousand.
class Schema {
 public:
  explicit Schema(const Json& schema);
  ~Schema();

  // What is wrong with the document, one sentence each, its place first; empty if it conforms.
  std::vector<std::string> violations(const Json& document) const;

 private:
  struct Parsed;
  std::unique_ptr<const Parsed> parsed_;
};

std::vector<std::string> schema_violations(const Json& document, const Json& schema);

}  // namespace isoline
