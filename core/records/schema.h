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

// A JSON text as what its single values are held to laws by: a tree in which long columns are
// short.

// Of a long list of numbers and texts its least and greatest integer, its least and greatest other
// number, and each of its texts once: laws on the kind, the bounds or the choices of an element
// hold for these where they hold for all. Laws on a list's length or order need the whole tree.
// UsageError names the origin where it is no JSON.
nlohmann::json outline_of(const std::string& text, const std::string& origin);

}  // namespace isoline
