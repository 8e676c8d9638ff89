// Rates belong neither to a problem nor to an optimizer: a table maps the pair to options, with the
// source of each value.
#pragma once

#include <map>
#include <string>

#include "core/record.h"

namespace isoline {

class Rates {
 public:
  Rates() = default;  // an empty table: every method at its defaults
  static Rates builtin();
  static Rates from_json(const Json& json, const std::string& origin);

  struct Row {
    Json options;        // to fill in
    std::string origin;  // file that says so
  };
  // The row for a problem in short form and an optimizer's name, or nullptr.
  const Row* find(const std::string& problem_spec, const std::string& optimizer) const;
  void add(const Rates& other);

 private:
  std::map<std::pair<std::string, std::string>, Row> rows_;
};

}  // namespace isoline
