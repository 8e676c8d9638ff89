// What the user of a problem wants of a run: a small loss, or the x that was sought.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace isoline {

enum class Aim {
  loss,  // f − f_L ≤ τ s: the loss is reached, whatever x
  x,     // the error in x is at most τ times the solution's norm: x is found
};
inline constexpr std::array<std::string_view, 2> kAimNames = {"loss", "x"};

inline std::string_view name_of(Aim aim) { return kAimNames[static_cast<std::size_t>(aim)]; }

inline std::optional<Aim> aim_of(std::string_view name) {
  for (std::size_t i = 0; i < kAimNames.size(); ++i)
    if (kAimNames[i] == name) return static_cast<Aim>(i);
  return std::nullopt;
}

}  // namespace isoline
