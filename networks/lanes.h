// The channels of one pixel as one vector, and dual numbers x + x' ε (Clifford 1873): an algorithm
// written once for T gives values with T = Lane, and its derivative along with T = Dual<Lane>.
#pragma once

#include <array>

#include "core/convolution.h"

namespace isoline::networks {

using Lane = float __attribute__((vector_size(4 * kChannels)));
using Wide = double __attribute__((vector_size(8 * kChannels)));  // long sums of lanes
using Mask = int __attribute__((vector_size(4 * kChannels)));

// What arrays of pixels are made of, for its alignment.
struct alignas(4 * kChannels) Pixel {
  float channel[kChannels];
};

template <class T>
struct Dual {
  T value{}, tangent{};

  friend Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.tangent + b.tangent};
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.tangent - b.tangent};
  }
  friend Dual operator-(const Dual& a) { return {-a.value, -a.tangent}; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.value * b.tangent + a.tangent * b.value};
  }
  friend Dual operator*(float c, const Dual& a) { return {c * a.value, c * a.tangent}; }
};
using DualLane = Dual<Lane>;

template <class T>
inline constexpr bool kIsDual = false;
template <class T>
inline constexpr bool kIsDual<Dual<T>> = true;

inline const Lane& value_of(const Lane& x) { return x; }
inline const Lane& value_of(const DualLane& x) { return x.value; }

// What a pullback is asked for: the value, or with duals the derivative of it.
inline const Lane& asked_of(const Lane& x) { return x; }
inline const Lane& asked_of(const DualLane& x) { return x.tangent; }

inline Lane choose(const Mask& mask, const Lane& a, const Lane& b) { return mask ? a : b; }
inline DualLane choose(const Mask& mask, const DualLane& a, const DualLane& b) {
  return {mask ? a.value : b.value, mask ? a.tangent : b.tangent};
}
template <class T>
T keep(const Mask& mask, const T& x) {  // 0 elsewhere; a kink has derivative 0
  return choose(mask, x, T{});
}
template <class T>
Mask is_positive(const T& x) {
  return value_of(x) > 0;
}

inline void accumulate(const Lane& x, Wide& sum) { sum += __builtin_convertvector(x, Wide); }

// An array of pixels and, where there are any, their tangents.
struct Place {
  float* value = nullptr;
  float* tangent = nullptr;

  Place operator+(Index pixels) const {
    const Index offset = pixels * kChannels;
    return {value + offset, tangent ? tangent + offset : nullptr};
  }
};

inline auto& lane(float* array, Index pixel) {
  using LaneOfFloats = float __attribute__((vector_size(4 * kChannels), may_alias));
  return *reinterpret_cast<LaneOfFloats*>(array + pixel * kChannels);
}

template <class T>
T load(const Place& place, Index pixel) {
  if constexpr (kIsDual<T>)
    return T{lane(place.value, pixel), lane(place.tangent, pixel)};
  else
    return T(lane(place.value, pixel));
}

template <class T>
void store(const Place& place, Index pixel, const T& x) {
  lane(place.value, pixel) = value_of(x);
  if constexpr (kIsDual<T>) lane(place.tangent, pixel) = x.tangent;
}

}  // namespace isoline::networks
