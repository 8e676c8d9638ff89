// Activations a = s(z) and their first two derivatives, number by number over flat arrays. Arrays
// are padded by their owner to whole vector registers: a remainder would be computed by other code,
// and a sample's bits would depend on its place.
//   relu max(0, z),  tanh,  sigmoid 1/(1 + e^(−z)),  gelu z Φ(z), Φ the normal distribution
//   function
#pragma once

#include <cmath>
#include <numbers>
#include <type_traits>

#include "core/product.h"

namespace isoline::networks {

enum class Activation { relu, tanh, sigmoid, gelu };

template <class Scalar>
using Flat = Eigen::Array<Scalar, Eigen::Dynamic, 1>;
template <class Scalar>
using FlatRef = const Eigen::Ref<const Flat<Scalar>>&;
template <class Scalar>
using FlatOut = Eigen::Ref<Flat<Scalar>>;

// φ(z) = e^(−z²/2)/√2π
template <class Scalar>
auto normal_density(FlatRef<Scalar> z) {
  constexpr auto kHeight = Scalar(std::numbers::inv_sqrtpi / std::numbers::sqrt2);
  return kHeight * (Scalar(-0.5) * z.square()).exp();
}

// out = Φ(z): in double by the C library, in float by Hastings' rational form (Abramowitz, Stegun
// (1964), 7.1.26), whose error of 7.5e-8 is that of single precision, and which vectorizes.
template <class Scalar>
void normal_distribution(FlatRef<Scalar> z, FlatOut<Scalar> out) {
  if constexpr (std::is_same_v<Scalar, double>) {
    out = z.unaryExpr([](double t) { return 0.5 * std::erfc(-t / std::numbers::sqrt2); });
  } else {
    constexpr float kScale = 0.3275911F / std::numbers::sqrt2_v<float>;
    out = (1 + kScale * z.abs()).inverse();
    out =
        0.5F * (-0.5F * z.square()).exp() * out *
        (0.254829592F +
         out * (-0.284496736F + out * (1.421413741F + out * (-1.453152027F + out * 1.061405429F))));
    out = (z > 0).select(1 - out, out);
  }
}

// In double as Cephes has it (Moshier, 1989): z + z³ P(z²)/Q(z²) about 0, 1 − 2/(e^(2|z|) + 1)
// beyond, to two units of the last place. The C library's function is not for vectors, and one
// number of it takes twenty times as long where wide registers are in use and nothing has cleared
// them.
template <class Scalar>
void hyperbolic_tangent(FlatRef<Scalar> z, FlatOut<Scalar> a) {
  if constexpr (std::is_same_v<Scalar, float>) {
    a = z.tanh();
  } else {
    constexpr double kNear = 0.625;
    a = 1 - 2 / ((2 * z.abs()).exp() + 1);
    for (Index i = 0; i < z.size(); ++i) {
      const double t = z[i], u = t * t;
      const double above =
          (-0.964399179425052238628 * u - 99.2877231001918586564) * u - 1614.68768441708447952;
      const double below =
          ((u + 112.811678491632931402) * u + 2235.48839060100448583) * u + 4844.06305325125486048;
      const double near = t + t * u * (above / below);
      a[i] = std::abs(t) < kNear ? near : t < 0 ? -a[i] : a[i];  // nan stays
    }
  }
}

// a = s(z)
template <class Scalar>
void activate(Activation kind, FlatRef<Scalar> z, FlatOut<Scalar> a) {
  if (kind == Activation::relu) {
    a = (z < 0).select(Scalar(0), z);  // not max, which would hide a nan
  } else if (kind == Activation::tanh) {
    hyperbolic_tangent<Scalar>(z, a);
  } else if (kind == Activation::sigmoid) {
    a = (1 + (-z).exp()).inverse();
  } else {
    normal_distribution<Scalar>(z, a);
    a *= z;
  }
}

// g = s'(z) g, given a = s(z); `room` is a scratch array of the same length.
template <class Scalar>
void multiply_by_slope(Activation kind, FlatRef<Scalar> z, FlatRef<Scalar> a, FlatOut<Scalar> g,
                       FlatOut<Scalar> room) {
  if (kind == Activation::relu) {
    g = (a > 0).select(g, Scalar(0));
  } else if (kind == Activation::tanh) {
    g *= 1 - a.square();
  } else if (kind == Activation::sigmoid) {
    g *= a * (1 - a);
  } else {
    normal_distribution<Scalar>(z, room);
    g *= room + z * normal_density<Scalar>(z);
  }
}

// g = s''(z) g
template <class Scalar>
void multiply_by_bend(Activation kind, FlatRef<Scalar> z, FlatRef<Scalar> a, FlatOut<Scalar> g) {
  if (kind == Activation::relu) {
    g.setZero();
  } else if (kind == Activation::tanh) {
    g *= -2 * a * (1 - a.square());
  } else if (kind == Activation::sigmoid) {
    g *= a * (1 - a) * (1 - 2 * a);
  } else {
    g *= (2 - z.square()) * normal_density<Scalar>(z);
  }
}

}  // namespace isoline::networks
