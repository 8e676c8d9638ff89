// The energy kept, and what that does to derivatives: with φ the factor, ∂φ/∂v = −φ v / Σ v² and
// ∂φ/∂v₀ = φ v₀ / Σ v₀².
#include "problems/physics/rescaling.h"

#include <cmath>
#include <tuple>
#include <utility>

#include "problems/physics/lattice_nodes.h"

namespace isoline::problems {
namespace {

// Σ x² and Σ y² side by side, for alone each would wait for its own sums; in the order of Eigen's.
// Whole fours, as the squares of even numbers are.
std::pair<Real, Real> squared_norms(Index size, const Real* x, const Real* y) {
  Four even_x{}, odd_x{}, even_y{}, odd_y{};
  const auto add_square = [](const Real* from, Four& sum) {
    const Four values = four_at(from);
    sum += values * values;
  };
  Index i = 0;
  for (; i + 8 <= size; i += 8) {
    add_square(x + i, even_x);
    add_square(x + i + 4, odd_x);
    add_square(y + i, even_y);
    add_square(y + i + 4, odd_y);
  }
  even_x += odd_x;
  even_y += odd_y;
  if (i < size) {
    add_square(x + i, even_x);
    add_square(y + i, even_y);
  }
  const auto total = [](const Four& sum) { return (sum[0] + sum[2]) + (sum[1] + sum[3]); };
  return {total(even_x), total(even_y)};
}

}  // namespace

Rescaling::Rescaling(VectorRef v0, VectorRef v) : factor(0) {
  std::tie(before, after) = squared_norms(v.size(), v0.data(), v.data());
  if (after != 0) factor = std::sqrt(before / after);  // nan stays nan
}

void Rescaling::pushforward(VectorRef v0, VectorRef v, VectorRef t0, VectorOut t) const {
  if (factor == 0) {
    t.setZero();
    return;
  }
  const Real change = factor * (v0.dot(t0) / before - v.dot(t) / after);
  t = factor * t + change * v;
}

void Rescaling::pullback(VectorRef v0, VectorRef v, VectorOut u, VectorOut u0) const {
  if (factor == 0) {
    u.setZero();
    return;
  }
  const Real change = factor * u.dot(v);
  u0 += (change / before) * v0;
  u = factor * u - (change / after) * v;
}

}  // namespace isoline::problems
