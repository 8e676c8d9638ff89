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

  // The errors in the document, one sentence each, beginning with the place; empty if it conforms.
  std::vector<std::string> violations(const Json& document) const;

 private:
  struct Parsed;
  std::unique_ptr<const Parsed> parsed_;
};

std::vector<std::string> schema_violations(const Json& document, const Json& schema);

// A JSON text in the form in which single values are checked: a tree with shortened columns.

// A long list of numbers and texts is reduced to its least and greatest integer, its least and
// greatest other number, and each of its texts once. Constraints on the type, the range or the
// choices of an element hold for these if and only if they hold for all. Constraints on a list's
// length or order need the complete tree. UsageError names the origin if it is not JSON.
nlohmann::json outline_of(const std::string& text, const std::string& origin);

}  // namespace isoline
