// The data of a forward pass for the products that follow it. Owned by the caller, so that
// physics and networks stay const; sized at first use, so that hot loops allocate nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/array.h"

namespace isoline {

// The choices made, in order.
class PieceDigest {
 public:
  void add(std::uint64_t choice) { state_ = (state_ ^ choice) * kPrime; }  // as FNV-1a, by words
  std::uint64_t value() const { return state_; }

 private:
  static constexpr std::uint64_t kPrime = 0x100000001b3;
  std::uint64_t state_ = 0xcbf29ce484222325;
};

// The differentiable pieces of a forward pass with nondifferentiable points; a Scratch is one, too.
struct Pieces {
  virtual ~Pieces() = default;
  virtual void add_choices(PieceDigest& digest) = 0;  // of the last forward pass
};

// The data of a component that is not an array of double: it derives its own type.
struct Scratch {
  virtual ~Scratch() = default;
};

struct Workspace {
  Matrix x;                       // (k, B) input of the last forward
  Matrix context;                 // (p, B) context of the last forward, empty for most
  std::vector<Matrix> saved;      // whatever else the component keeps; its own business
  bool saved_is_current = false;  // whether `saved` belongs to x; false after each forward
  std::unique_ptr<Scratch> own;   // as `saved`, of the component's own type
  Matrix unit, product, dense;    // of Jacobians and curvatures made from other products

  template <class Own>
  Own& as() {
    if (!own) own = std::make_unique<Own>();
    return static_cast<Own&>(*own);
  }
};

}  // namespace isoline
