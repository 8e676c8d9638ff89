// Kinks, declared by whoever has them: the smooth pieces of a map between its kinks are told apart
// by the choices that a forward pass made, which side of 0 each number fell on, which limit held.
// Between two points of one piece differences approach derivatives; across a kink they do not.
#pragma once

#include <cstdint>

namespace isoline {

// Of the choices made, in order.
class PieceDigest {
 public:
  void add(std::uint64_t choice) { state_ = (state_ ^ choice) * kPrime; }  // as FNV-1a, by words
  std::uint64_t value() const { return state_; }

 private:
  static constexpr std::uint64_t kPrime = 0x100000001b3;
  std::uint64_t state_ = 0xcbf29ce484222325;
};

// What a forward pass leaves behind where the map has kinks: a component's Scratch is one, too.
struct Pieces {
  virtual ~Pieces() = default;
  virtual void add_choices(PieceDigest& digest) = 0;  // of the last forward pass
};

}  // namespace isoline
