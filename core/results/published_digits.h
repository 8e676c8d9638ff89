// Mean log relative errors on NIST's certified regressions that others have published: the header
// of Ceres' examples/nist.cc, and through it Mondragon and Borchers (2005).
#pragma once

#include <utility>

#include "core/real.h"

namespace isoline::results {

inline constexpr std::pair<const char*, Real> kPublishedDigits[] = {
    {"Ceres", 9.4},   {"HBN", 6.8},      {"MINPACK", 4.4},
    {"gnuplot", 4.3}, {"GaussFit", 4.0}, {"Excel", 2.3}};

}  // namespace isoline::results
