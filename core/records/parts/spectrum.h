// Singular values of J = ∂y/∂θ over the batch of a step, descending, if --spectrum was set.
#pragma once

#include <cstdint>
#include <vector>

#include "core/errors.h"
#include "core/real.h"
#include "core/records/part.h"

namespace isoline {

// Without iterations: J is not formed, or too large. Only one of two runs may keep it.
struct Spectrum {
  static constexpr Part kPart{
      .member = "spectrum",
      .law = R"({"description": "Singular values of J, if --spectrum was set"})",
      .ignored = "*"};
  std::vector<std::int64_t> iterations = {};
  std::vector<std::vector<Real>> sigma = {};  // one spectrum an iteration

  bool operator==(const Spectrum&) const = default;
};

void fields(Like<Spectrum> auto& spectrum, auto& field) {
  field("iterations", spectrum.iterations);
  field("sigma", spectrum.sigma);
}

inline void require_sound(const Spectrum& spectrum) {
  require(spectrum.iterations.size() == spectrum.sigma.size(),
          "the numbers of its spectra and of their iterations differ");
}

}  // namespace isoline
