// How a broken contract is reported. Numerical failure is a status, never one of these.
#pragma once

#include <concepts>
#include <stdexcept>
#include <string>

namespace isoline {

// The caller requested something impossible: a bad option, a wrong shape, an unknown name.
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

// For constraints whose message names the value: the text is built only on failure.
template <std::invocable Law>
void require(bool holds, const Law& law) {
  if (!holds) throw UsageError(law());
}

}  // namespace isoline
