// One optimizer under audit: runs of it on any problem, every oracle granted, and counted.
#pragma once

#include <optional>
#include <vector>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

struct Path {
  std::vector<Vector> x;  // (n) each, the start first
  OracleCounts counts{};
  std::int64_t iterations = 0;
};

class Subject {
 public:
  Subject(const Catalog& catalog, const OptimizerEntry& entry, OptionValues options)
      : catalog_(catalog), entry_(entry), options_(std::move(options)) {}

  std::string why_inapplicable(const Problem& problem) const;
  OracleSet needs(const Problem& problem) const;

  // As far as it comes: a method that throws has gone as far as its trace.
  Path run(const Problem& problem, std::int64_t iterations) const;

  // The first step that is one; nothing where there is none.
  std::optional<Vector> first_step(const Problem& problem) const;

 private:
  const Catalog& catalog_;
  const OptimizerEntry& entry_;
  const OptionValues options_;
};

}  // namespace isoline::benchmarks
