// Counter-based random numbers (Philox4x64-10, Salmon et al. 2011), by named stream: a sample
// depends on its key alone, not on order, thread, shard or standard library.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/real.h"

namespace isoline {

// One number after the other; core/random.h has arrays of them.
class Draws {
 public:
  // `component` is a problem's name without options; `index` numbers the sample.
  Draws(std::uint64_t seed, std::string_view component, std::string_view purpose,
        std::uint64_t index = 0);

  void restart(std::uint64_t index);  // another sample, from its beginning; the key the same

  Real uniform();                     // U[0, 1)
  Real uniform(Real low, Real high);  // U[low, high)
  Real normal();                      // N(0, 1), by Box and Muller

 protected:
  std::uint64_t next();

 private:
  std::array<std::uint64_t, 2> key_;
  std::uint64_t index_, block_ = 0;
  std::array<std::uint64_t, 4> buffer_{};
  int left_ = 0;
};

}  // namespace isoline
