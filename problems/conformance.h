// Measures the required properties of every problem: its products against each other and against
// differences, its inverse against its forward, its declared solution against its loss.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/random.h"
#include "problems/problem.h"

namespace isoline::problems {

struct Finding {
  std::string property;                           // a sentence that should be true
  Real figure, limit;                             // what was measured, and the most it may be
  std::string reason;                             // why that limit
  bool holds() const { return figure <= limit; }  // false for nan
};

// Measures at a random point as close to the start as the starts of seeds. Skips what a problem
// does not offer; uses dense matrices only up to some millions of entries.
// Calls `before` ahead of each check, with the number of checks done and of all.
using CheckListener = std::function<void(std::size_t done, std::size_t all)>;
std::vector<Finding> examine(const Problem& problem, RandomStream& stream,
                             const CheckListener& before = {});

}  // namespace isoline::problems
