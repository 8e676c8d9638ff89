// The array types of the project. Shapes are written in comments as (rows, columns).
#pragma once

#include <Eigen/Core>

#include "core/real.h"

namespace isoline {

static_assert(std::is_same_v<Index, Eigen::Index>);

using Vector = Eigen::VectorXd;  // (n)
using Matrix = Eigen::MatrixXd;  // (m, n), column major; a batch holds one sample per column

using VectorRef = const Eigen::Ref<const Vector>&;
using VectorOut = Eigen::Ref<Vector>;
using BatchRef = const Eigen::Ref<const Matrix>&;
using BatchOut = Eigen::Ref<Matrix>;

using Success = Eigen::Array<bool, Eigen::Dynamic, 1>;  // (B), one flag per sample

// x − x is 0 where x is finite and nan elsewhere: a sum that vectorizes, where Eigen's allFinite
// looks at one number at a time.
template <class Array>
bool is_finite(const Array& array) {
  return (array.array() - array.array()).sum() == 0;
}

}  // namespace isoline
