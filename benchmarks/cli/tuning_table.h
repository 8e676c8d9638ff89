// What a tuning came to, as a person reads it.
#pragma once

#include <string>

#include "benchmarks/run/tune.h"

namespace isoline::benchmarks {

// How many pairs were tuned, at which edges the best stand and what ties; a line a pair, twenty at
// most unless all are wanted, with a plot of its scores in a few characters; of one pair a larger
// plot.
std::string tuning_text(const TuningResult& result, bool lists_all);

}  // namespace isoline::benchmarks
