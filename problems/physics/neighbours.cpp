// Sums of neighbours, column by column.
#include "problems/physics/neighbours.h"

namespace isoline::problems {
namespace {

template <bool adds>
void put(Real value, Real& out) {
  if constexpr (adds)
    out += value;
  else
    out = value;
}

template <bool adds>
void sweep(Index N, Real a, Real b, Side side, const Real* __restrict q, Real* __restrict out) {
  for (Index j = 0; j < N; ++j) {
    const Real* own = q + N * j;
    Real* to = out + N * j;
    if (side == Side::right) {
      for (Index i = 0; i + 1 < N; ++i) put<adds>(a * own[i] + b * own[i + 1], to[i]);
      put<adds>(a * own[N - 1] + b * own[0], to[N - 1]);
    } else if (side == Side::left) {
      put<adds>(a * own[0] + b * own[N - 1], to[0]);
      for (Index i = 1; i < N; ++i) put<adds>(a * own[i] + b * own[i - 1], to[i]);
    } else {
      const Index beside = side == Side::above ? (j + 1 < N ? j + 1 : 0) : (j > 0 ? j - 1 : N - 1);
      const Real* other = q + N * beside;
      for (Index i = 0; i < N; ++i) put<adds>(a * own[i] + b * other[i], to[i]);
    }
  }
}

}  // namespace

void weigh(Index N, Real a, Real b, Side side, VectorRef q, VectorOut out) {
  sweep<false>(N, a, b, side, q.data(), out.data());
}
void add_weighed(Index N, Real a, Real b, Side side, VectorRef q, VectorOut out) {
  sweep<true>(N, a, b, side, q.data(), out.data());
}

}  // namespace isoline::problems
