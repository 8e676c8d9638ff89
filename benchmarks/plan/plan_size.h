// How large a plan is, counted by multiplication before anything of it is made.
#pragma once

#include <cstdint>
#include <string>

#include "benchmarks/plan/suite.h"

namespace isoline::benchmarks {

struct PlanSize {
  std::uint64_t cells = 0;  // at most: a cell that two blocks have is run once
  std::string largest;  // the factors of the largest block: "50,000 seeds × 400 settings of sine"
};

PlanSize size_of(const Catalog& catalog, const Suite& suite);

// "the plan has 20,000,000 cells, more than 1,000,000: 50,000 seeds × 400 settings of sine"
std::string too_large(const PlanSize& size, std::uint64_t most);

}  // namespace isoline::benchmarks
