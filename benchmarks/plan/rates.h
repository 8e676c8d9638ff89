// Rates belong neither to a problem nor to an optimizer: a table maps the options of a problem and
// an optimizer to options, with the source of each value.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/records/request.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

class Rates {
 public:
  Rates() = default;  // an empty table: every method at its defaults
  static Rates builtin();
  static Rates named(const std::string& given);  // "builtin", "none" or the path of a file
  static Rates from_json(const Json& json, const std::string& origin);

  struct Row {
    OptionValues problem;  // the options that it is for, as text
    OptionValues options;  // to fill in
    std::string origin;    // file that says so
    std::string source;    // the paper or the grid that each value is from, as JSON text
    bool is_from_grid = false;
  };
  // The row for a problem and an optimizer's name, or nullptr. A row is for the problems that have
  // the options it names, in their default mode unless it names the mode; the row that names most
  // wins, and the last of these. `table` restricts the search to one file; tables of tuned rates
  // are searched only so.
  const Row* find(const Component& problem, const std::string& optimizer,
                  const std::string& table = "") const;
  void add(const Rates& other);

 private:
  std::map<std::pair<std::string, std::string>, std::vector<Row>> rows_;  // by names
};

}  // namespace isoline::benchmarks
