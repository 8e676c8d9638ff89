// How large a plan is, counted by multiplication before anything of it is made.
#pragma once

#include <cstdint>
#include <string>

#include "benchmarks/plan/suite.h"

namespace isoline::benchmarks {

inline constexpr std::uint64_t kMostCells = 1'000'000;

struct PlanSize {
  std::uint64_t cells = 0;  // at most: a cell that two blocks have is run once
  std::string largest;  // the factors of the largest block: "50,000 seeds × 400 settings of sine"
};

PlanSize size_of(const Catalog& catalog, const Suite& suite);

// UsageError over kMostCells, with the size and what makes it so large.
void require_ordinary(const PlanSize& size);

}  // namespace isoline::benchmarks
