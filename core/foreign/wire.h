// The frames between this program and another on a socket: a head of 16 bytes, then so many bytes
// as it says. All numbers are little-endian; a payload is doubles or UTF-8 text.
// docs/wire-format.md has it to the byte.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace isoline {

static_assert(std::endian::native == std::endian::little, "frames are copied as they stand");

inline constexpr std::int64_t kWireProtocol = 1;
// Bytes of the longest text: a handshake holds vectors.
inline constexpr std::uint64_t kMostHandshake = std::uint64_t{64} << 20;
inline constexpr std::uint64_t kMostWireText = std::uint64_t{64} << 10;

enum class Verb : std::uint32_t {
  hello = 1,  // the handshake, both ways, as JSON
  // What a problem is asked. The status of the question is the number of a point.
  linearize = 2,    // x (k, B) -> y (m, B), and what products there need
  pushforward = 3,  // v (k, B) -> J v (m, B)
  pullback = 4,     // u (m, B) -> Jᵀ u (k, B)
  jacobian = 5,     // -> J of each sample side by side, (m, k·B)
  inverse = 6,      // y (m, B), x₀ (k, B) -> x (k, B), then a 1 or 0 of success a sample
  // What an optimizer is told, once; then it asks, the point first.
  begin = 16,               // n and the count of residuals, as doubles; θ₀ (n)
  value = 17,               // θ -> L
  gradient = 18,            // θ -> ∇L (n)
  value_and_gradient = 19,  // θ -> L, ∇L
  residual = 20,            // θ -> r = (y − y*)/√B
  jacobian_of_r = 21,       // θ -> ∂r/∂θ, column by column
  pushforward_of_r = 22,    // θ, v (n) -> (∂r/∂θ) v
  pullback_of_r = 23,       // θ, w -> (∂r/∂θ)ᵀ w (n)
  hessian_product = 24,     // θ, v (n) -> ∇²L v
  report = 32,              // θ of an iteration -> nothing
  finish = 33,              // the θ to be judged -> nothing
  claim = 34,               // text: what it says of its own success -> nothing
};

// Of an answer. A question has 0, or a point's number.
enum class Answer : std::uint32_t {
  done = 0,
  failed = 1,  // the payload is why, as text
  stop = 2,    // to an optimizer: the run is over, there is no more to ask
};

struct FrameHead {
  std::uint32_t verb = 0, status = 0;
  std::uint64_t bytes = 0;
};
static_assert(sizeof(FrameHead) == 16);

std::string_view name_of(Verb verb);  // "pullback"; "an unknown verb"

}  // namespace isoline
