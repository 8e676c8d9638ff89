// What a value of a tuned option came to, and which of several is best.
#pragma once

#include <cstddef>
#include <vector>

#include "core/records/record.h"

namespace isoline::benchmarks {

// The median work to τ = 1e-6 of what the problem's user wants, then the median of what was left at
// the end, the loss or the error in x; less is better.
struct TuningScore {
  Real work = std::numeric_limits<Real>::infinity();
  Real left = std::numeric_limits<Real>::infinity();
  bool operator==(const TuningScore&) const = default;
  bool operator<(const TuningScore& other) const {
    return work != other.work ? work < other.work : left < other.left;
  }
};

// Of the runs of one value, a seed each. One that diverged or failed leaves neither number.
// Learning problems are judged by what is left on their validation alone.
TuningScore score_of(const std::vector<Record>& runs);

// Which of the values is best. Ties go to the default, or to what is nearest to it on a logarithmic
// axis.
std::size_t best_value(const std::vector<Real>& values, const std::vector<TuningScore>& scores,
                       Real standard);

// E[best of b] of n losses: Σ y₍ᵢ₎ C(n − i, b − 1)/C(n, b) over the sorted ones, for b = 1 … n.
std::vector<Real> best_of(std::vector<Real> losses);

}  // namespace isoline::benchmarks
