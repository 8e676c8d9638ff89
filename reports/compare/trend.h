// The headline figures of results, and of the baselines of earlier commits beside them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "reports/compare/subject.h"

namespace isoline::reports {

// One of the methods that solve most runs.
struct HeadlineMethod {
  std::string name;
  std::size_t solved = 0, runs = 0;
  Real median_work = kNever;  // to 1e-6, of all its runs
};

struct Headline {
  std::string label;                                     // "2026-07-01 0f1e2d3", "NEW"
  std::size_t runs = 0, failed = 0;                      // inapplicable ones left out
  std::array<std::size_t, kTolerances.size()> solved{};  // runs, in the sense of their aim
  std::vector<HeadlineMethod> leaders;                   // at 1e-6, three at most
};

Headline headline_of(const std::string& label, const std::vector<Subject>& subjects);

Json headline_json(const Headline& headline);  // without the label
Headline headline_from_json(const std::string& label, const Json& json);

}  // namespace isoline::reports
