// The projection, by a spectral solve.
#include "problems/physics/projection.h"

#include <cmath>
#include <numbers>

#include "problems/physics/neighbours.h"

namespace isoline::problems {
namespace {

// The divergence between faces, in one pass.
void diverge(Index N, const Real* __restrict u, const Real* __restrict v, Real* __restrict out) {
  for (Index j = 0; j < N; ++j, u += N, out += N) {
    const Real *below = v + N * j, *above = v + (j + 1 < N ? N * (j + 1) : 0);
    for (Index i = 0; i + 1 < N; ++i) out[i] = (u[i + 1] - u[i]) + (above[i] - below[i]);
    out[N - 1] = (u[0] - u[N - 1]) + (above[N - 1] - below[N - 1]);
  }
}

}  // namespace

Projection::Projection(Index N, Arrangement arrangement)
    : N_(N),
      arrangement_(arrangement),
      fourier_(N, N),
      inverse_(Matrix::Zero(N / 2 + 1, N)),
      pressure_(N * N) {
  const bool is_staggered = arrangement == Arrangement::staggered;
  // Where i is a multiple of half the period the sine of the wide difference is 0, to the bit.
  const auto square = [&](Index i) {
    if (!is_staggered && 2 * i % N == 0) return 0.0;
    const Real angle = std::numbers::pi * static_cast<Real>(i) / static_cast<Real>(N);
    const Real sine = std::sin(is_staggered ? angle : 2 * angle);
    return (is_staggered ? 4 : 1) * sine * sine;
  };
  for (Index j = 0; j < N; ++j)
    for (Index i = 0; i <= N / 2; ++i) {
      const Real symbol = square(i) + square(j);
      if (symbol > 0) inverse_(i, j) = -1 / (symbol * fourier_.round_trip());
    }
}

void Projection::divergence(VectorRef u, VectorRef v, VectorOut out) const {
  if (arrangement_ == Arrangement::staggered) {
    diverge(N_, u.data(), v.data(), out.data());
  } else {
    weigh(N_, 0, 0.5, Side::right, u, out);
    add_weighed(N_, 0, -0.5, Side::left, u, out);
    add_weighed(N_, 0, 0.5, Side::above, v, out);
    add_weighed(N_, 0, -0.5, Side::below, v, out);
  }
}

void Projection::apply(VectorOut u, VectorOut v) {
  divergence(u, v, pressure_);
  fourier_.forward(pressure_);
  fourier_.spectrum().array() *= inverse_.array();
  fourier_.inverse(pressure_);
  if (arrangement_ == Arrangement::staggered) {
    add_weighed(N_, -1, 1, Side::left, pressure_, u);
    add_weighed(N_, -1, 1, Side::below, pressure_, v);
  } else {
    add_weighed(N_, 0, -0.5, Side::right, pressure_, u);
    add_weighed(N_, 0, 0.5, Side::left, pressure_, u);
    add_weighed(N_, 0, -0.5, Side::above, pressure_, v);
    add_weighed(N_, 0, 0.5, Side::below, pressure_, v);
  }
}

}  // namespace isoline::problems
