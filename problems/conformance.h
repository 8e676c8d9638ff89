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

// How far the checks are. Where another program takes 0.1 s or longer for its first call: the time
// of that call, and about how many calls of forward all checks make.
struct CheckProgress {
  std::size_t done, all;
  double call_seconds = 0;
  Index calls = 0;
};

// Measures at a random point as close to the start as the starts of seeds. Skips what a problem
// does not offer; uses dense matrices only up to some millions of entries. Of a slow program, it
// makes few calls: fewer steps of Taylor's remainder, and of derivatives that are differences
// themselves only the gradient.
// Calls `before` ahead of each check.
using CheckListener = std::function<void(const CheckProgress&)>;
std::vector<Finding> examine(const Problem& problem, RandomStream& stream,
                             const CheckListener& before = {});

}  // namespace isoline::problems
