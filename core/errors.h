// How a broken contract is reported. Numerical failure is a status, never one of these.
#pragma once

#include <concepts>
#include <stdexcept>
#include <string>

namespace isoline {

// The caller asked for something impossible: a bad option, a wrong shape, an unknown name.
struct UsageError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

// This optimizer cannot treat this problem; the cell is recorded with the reason.
struct NotApplicable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline void require(bool holds, const char* law) {
  if (!holds) throw UsageError(law);
}

// For laws that name what was given: their text is made only where they are broken.
template <std::invocable Law>
void require(bool holds, const Law& law) {
  if (!holds) throw UsageError(law());
}

}  // namespace isoline
