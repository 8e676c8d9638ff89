// Counter-based random streams by Random123; the only adapter to it.
#include "core/random.h"

#include <Random123/philox.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/files.h"

namespace isoline {
Draws::Draws(std::uint64_t seed, std::string_view component, std::string_view purpose,
             std::uint64_t index)
    : key_{seed, fnv1a(purpose, fnv1a("/", fnv1a(component)))}, index_(index) {}

void Draws::restart(std::uint64_t index) {
  index_ = index;
  block_ = 0;
  left_ = 0;
}

RandomStream RandomStream::of_sample(std::uint64_t index) const {
  RandomStream other = *this;
  other.restart(index);
  return other;
}

std::uint64_t Draws::next() {
  if (left_ == 0) {
    const r123::Philox4x64::ctr_type counter{{index_, block_++, 0, 0}};
    const auto drawn = r123::Philox4x64()(counter, {{key_[0], key_[1]}});
    for (std::size_t i = 0; i < buffer_.size(); ++i) buffer_[i] = drawn[i];
    left_ = static_cast<int>(buffer_.size());
  }
  return buffer_[static_cast<std::size_t>(--left_)];
}

Real Draws::uniform() {
  constexpr Real kUnit = 0x1p-53;  // the top 53 bits fill a double's mantissa
  return static_cast<Real>(next() >> 11) * kUnit;
}

Real Draws::uniform(Real low, Real high) { return low + (high - low) * uniform(); }

Real Draws::normal() {
  const Real radius = std::sqrt(-2 * std::log(1 - uniform()));
  return radius * std::cos(2 * std::numbers::pi * uniform());
}

Vector RandomStream::normal_vector(Index n) {
  Vector drawn(n);
  for (Real& value : drawn) value = normal();
  return drawn;
}

Vector RandomStream::uniform_vector(Index n, Real low, Real high) {
  Vector drawn(n);
  for (Real& value : drawn) value = uniform(low, high);
  return drawn;
}

void RandomStream::signs(VectorOut out) {
  constexpr Index kBits = 64;
  for (Index first = 0; first < out.size(); first += kBits) {
    std::uint64_t bits = next();
    for (Index i = first; i < std::min(first + kBits, out.size()); ++i, bits >>= 1)
      out[i] = 2 * static_cast<Real>(bits & 1U) - 1;
  }
}

}  // namespace isoline
