// Forward-mode differentiation: a value with its derivatives by N unknowns. A formula written for
// any scalar gives its gradient by Jet<Real, N>, and its Hessian by Jet<Jet<Real, N>, N>.
#pragma once

#include <array>
#include <cmath>

#include "core/real.h"

namespace isoline::problems {

// With these for Real, a formula reads alike for every scalar.
using std::atan, std::cos, std::exp, std::log, std::pow, std::sin, std::sqrt;

template <class T, int N>
struct Jet {
  T value{};
  std::array<T, N> by{};  // ∂value/∂xᵢ

  Jet() = default;
  Jet(Real constant) : value(constant) {}
  // f(g) by the chain rule: f and f' at g, and g's derivatives.
  Jet(const T& f, const T& slope, const Jet& g) : value(f) {
    for (int i = 0; i < N; ++i) by[i] = slope * g.by[i];
  }

  Jet& operator+=(const Jet& b) {
    value += b.value;
    for (int i = 0; i < N; ++i) by[i] += b.by[i];
    return *this;
  }
  Jet& operator-=(const Jet& b) { return *this += -b; }
  Jet operator-() const { return {-value, T(-1), *this}; }

  friend Jet operator+(Jet a, const Jet& b) { return a += b; }
  friend Jet operator-(Jet a, const Jet& b) { return a -= b; }
  friend Jet operator*(const Jet& a, const Jet& b) {
    Jet c(a.value * b.value, b.value, a);
    for (int i = 0; i < N; ++i) c.by[i] += a.value * b.by[i];
    return c;
  }
  friend Jet operator/(const Jet& a, const Jet& b) {
    const T f = a.value / b.value, slope = T(1) / b.value;
    Jet c(f, slope, a);
    for (int i = 0; i < N; ++i) c.by[i] += -(f * slope) * b.by[i];
    return c;
  }
  friend Jet pow(const Jet& a, const Jet& b) {  // a > 0
    const T f = pow(a.value, b.value);
    Jet c(f, f * b.value / a.value, a);
    for (int i = 0; i < N; ++i) c.by[i] += f * log(a.value) * b.by[i];
    return c;
  }
};

template <class T, int N>
Jet<T, N> exp(const Jet<T, N>& a) {
  const T f = exp(a.value);
  return {f, f, a};
}
template <class T, int N>
Jet<T, N> log(const Jet<T, N>& a) {
  return {log(a.value), T(1) / a.value, a};
}
template <class T, int N>
Jet<T, N> sqrt(const Jet<T, N>& a) {
  const T f = sqrt(a.value);
  return {f, T(0.5) / f, a};
}
template <class T, int N>
Jet<T, N> sin(const Jet<T, N>& a) {
  return {sin(a.value), cos(a.value), a};
}
template <class T, int N>
Jet<T, N> cos(const Jet<T, N>& a) {
  return {cos(a.value), -sin(a.value), a};
}
template <class T, int N>
Jet<T, N> atan(const Jet<T, N>& a) {
  return {atan(a.value), T(1) / (T(1) + a.value * a.value), a};
}

}  // namespace isoline::problems
