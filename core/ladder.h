// The ladder of targets by which runs are compared: τ_j = 10^(−j/5), j = 0 … 50.
#pragma once

#include <cmath>

#include "core/real.h"

namespace isoline {

inline constexpr int kRungs = 51;
inline Real rung(std::size_t j) { return std::pow(10.0, -static_cast<Real>(j) / 5); }

}  // namespace isoline
