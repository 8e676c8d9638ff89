// Tables of rates and of the lowest known losses, which belong neither to a problem nor to an
// optimizer.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/records/record.h"
#include "core/records/request.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

// By the options of a problem and an optimizer: options, with the source of each value.
class Rates {
 public:
  Rates() = default;  // an empty table: every method at its defaults
  static Rates builtin();
  static Rates named(const std::string& given);  // "builtin", "none" or the path of a file
  static Rates from_text(const std::string& text, const std::string& origin);

  struct Row {
    OptionValues problem;  // the options that it is for, as text
    OptionValues options;  // to fill in
    std::string setting;   // the problem's spec, as the table has it
    std::string origin;    // file that says so
    std::string source;    // the paper or the grid that each value is from, as JSON text
    bool is_from_grid = false;

    // Whether it is for this very setting, not for all that share the options which it names.
    bool names_all_of(const Component& asked) const;
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

// The best known losses: f_L of problems that declare no f_L or an unattained bound, by problem,
// options and seed, in benchmarks/best.json and in a table of --best. Runs read them when they
// create their problem; reports do not change it.

class BestLosses {
 public:
  static const BestLosses& known();  // those of the build, and of tables that were added
  static void add_known(const std::string& path);  // before any problem is completed
  static BestLosses from_json(const Json& json, const std::string& origin);
  Json to_json() const;

  std::optional<Real> find(const Component& problem, std::uint64_t seed) const;

  // The row of a problem at all seeds, as text, for a part of the digest of a build. Empty: none.
  std::string losses_text(const Component& problem) const;

  // The lesser of what is known and the best loss that the record has seen; whether that changed.
  bool add(const Record& record);

 private:
  struct Loss {
    Real loss;
    std::string optimizer;  // the spec of the method that found it
  };
  struct Row {
    std::string problem;
    OptionValues options;  // all of them
    std::map<std::uint64_t, Loss> losses;
  };
  std::size_t place_of(const Component& problem) const;  // of its row; their number where none is

  std::vector<Row> rows_;
};

}  // namespace isoline::benchmarks
