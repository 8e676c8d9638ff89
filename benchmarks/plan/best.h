// The best losses known, f_L of problems that declare none or whose bound nobody attains: by
// problem, all its options and seed, in benchmarks/best.json. Runs read it when their problem is
// made; no report changes it.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/records/record.h"

namespace isoline::benchmarks {

class BestLosses {
 public:
  static const BestLosses& builtin();
  static BestLosses from_json(const Json& json, const std::string& origin);
  Json to_json() const;

  std::optional<Real> find(const Component& problem, std::uint64_t seed) const;

  // Of a problem at all seeds, as text: what a digest of the problem is also of. Empty: none.
  std::string text_of(const Component& problem) const;

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
