// What an optimizer may ask of a problem, by kind; the ledger counts each.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace isoline {

enum class Oracle {
  forward,          // y = P(N(θ)) and L
  pullback,         // Jᵀ w
  pushforward,      // J v
  jacobian,         // J, (m, n)
  hessian,          // ∇²L, (n, n)
  curvature,        // Σ wᵢ ∇²Pᵢ, (k, k) a sample
  sensitivity,      // ∂y/∂x, (m, k) a sample, through the physics alone
  hessian_product,  // ∇²L v
  inverse,          // P⁻¹(y; x)
  network,          // (∂x/∂θ)ᵀ w, through the network alone
  layer_factors,    // inputs and cotangents of each dense layer
  truth,            // the x* that made y*: a privilege
};
inline constexpr std::array<std::string_view, 12> kOracleNames = {
    "forward",     "pullback",        "pushforward", "jacobian", "hessian",       "curvature",
    "sensitivity", "hessian_product", "inverse",     "network",  "layer_factors", "truth"};
inline constexpr std::size_t kOracles = kOracleNames.size();

using OracleCounts = std::array<std::int64_t, kOracles>;

inline std::string_view name_of(Oracle oracle) {
  return kOracleNames[static_cast<std::size_t>(oracle)];
}

// A set of oracles: what a method needs, or what a problem offers.
class OracleSet {
 public:
  constexpr OracleSet() = default;
  constexpr OracleSet(std::initializer_list<Oracle> oracles) {
    for (const Oracle oracle : oracles) bits_ |= bit(oracle);
  }
  constexpr bool contains(Oracle oracle) const { return (bits_ & bit(oracle)) != 0; }
  constexpr void add(Oracle oracle) { bits_ |= bit(oracle); }

 private:
  static constexpr unsigned bit(Oracle oracle) { return 1U << static_cast<unsigned>(oracle); }
  unsigned bits_ = 0;
};

}  // namespace isoline
