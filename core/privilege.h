// Extra information that a method may use and others do not: a fact of the run, stored by name.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace isoline {

enum class Privilege {
  exact_hessian,
  exact_inverse,
  damped_inverse,
  approximate_inverse,
  estimate,
  ground_truth,
};
inline constexpr std::array<std::string_view, 6> kPrivilegeNames = {
    "exact Hessian",
    "exact inverse of the physics",
    "damped inverse of the physics",
    "approximate inverse of the physics",
    "estimate by how the data were made",
    "ground truth"};
inline std::string_view name_of(Privilege privilege) {
  return kPrivilegeNames[static_cast<std::size_t>(privilege)];
}

// Whether this extra information is an inverse of the physics.
inline bool is_inverse_of_physics(std::string_view privilege) {
  using enum Privilege;
  return std::ranges::any_of(std::array{exact_inverse, damped_inverse, approximate_inverse},
                             [&](Privilege each) { return name_of(each) == privilege; });
}

}  // namespace isoline
