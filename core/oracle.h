// The oracles of a problem, by kind, which the ledger counts; and extra information by name.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace isoline {

enum class Oracle {
  forward,
  pullback,
  pushforward,
  jacobian,
  sparse_jacobian,
  hessian,
  curvature,
  sensitivity,
  hessian_product,
  inverse,
  network,
  layer_factors,
  layer_moments,
  truth
};

// The sizes of a problem that determine costs.
struct OracleSizes {
  std::int64_t unknowns, residuals;  // n, and m·B, the rows of J
  std::int64_t inputs, outputs;      // k, m
  std::int64_t pushforward_price, pullback_price;
  bool has_pushforward, has_pullback;
  std::int64_t widest_row;     // most nonzeros in a row of a sparse J
  std::int64_t inverse_price;  // as the physics declares it
  bool has_network;            // other than the identity
};

// The cost of a matrix with so many columns and rows, from the cheaper product.
inline std::int64_t matrix_price(const OracleSizes& of, std::int64_t columns, std::int64_t rows) {
  const std::int64_t by_column = columns * of.pushforward_price, by_row = rows * of.pullback_price;
  if (!of.has_pushforward) return by_row;
  return of.has_pullback ? std::min(by_column, by_row) : by_column;
}

struct OracleRow {
  Oracle kind;
  std::string_view name;
  std::string_view asks;                      // what is computed
  std::int64_t (*price)(const OracleSizes&);  // declared, in forwards
  std::string_view lack;                      // why a problem does not offer it, in words
  bool is_dense_matrix = false;
  bool is_in_every_record = true;  // records of older versions lack what was counted later
};

// All properties of the kinds of oracles, in their order. A new kind is a row here, its computation
// in problems/problem.cpp, its call in optimizers/meter.cpp and benchmarks/run/sheets.cpp, and the
// renewed schema of records.
inline constexpr std::array kOracleTable = {
    OracleRow{Oracle::forward, "forward", "y = P(N(θ)) and L",
              [](const OracleSizes&) -> std::int64_t { return 1; }, ""},
    OracleRow{Oracle::pullback, "pullback", "Jᵀ w",
              [](const OracleSizes& of) { return of.pullback_price; },
              "the problem offers no gradients"},
    OracleRow{Oracle::pushforward, "pushforward", "J v",
              [](const OracleSizes& of) { return of.pushforward_price; },
              "the problem offers no products J v"},
    OracleRow{Oracle::jacobian, "jacobian", "J, (m, n)",
              [](const OracleSizes& of) { return matrix_price(of, of.unknowns, of.residuals); },
              "the Jacobian is not offered, or would be too large to form", true},
    OracleRow{Oracle::sparse_jacobian, "sparse_jacobian", "the values of a sparse J",
              // the least number of products from which its columns, compressed, can be read;
              // Curtis, Powell, Reid (1974)
              [](const OracleSizes& of) { return of.widest_row; },
              "the problem declares no sparse Jacobian", false, false},
    OracleRow{Oracle::hessian, "hessian", "∇²L, (n, n)",
              [](const OracleSizes& of) { return of.unknowns; },
              "the problem offers no second derivatives", true},
    OracleRow{Oracle::curvature, "curvature", "Σ wᵢ ∇²Pᵢ, (k, k) per sample",
              [](const OracleSizes& of) { return of.inputs; },
              "the problem offers no second derivatives", true},
    OracleRow{Oracle::sensitivity, "sensitivity",
              "∂y/∂x, (m, k) per sample, through the physics alone",
              [](const OracleSizes& of) { return matrix_price(of, of.inputs, of.outputs); },
              "the Jacobian is not offered, or would be too large to form", true, false},
    OracleRow{Oracle::hessian_product, "hessian_product", "∇²L v",
              // a pushforward, and the pullback's own derivative
              [](const OracleSizes&) -> std::int64_t { return 2; },
              "the problem offers no products with the Hessian", false, false},
    OracleRow{Oracle::inverse, "inverse", "P⁻¹(y; x)",
              [](const OracleSizes& of) { return of.inverse_price; },
              "the physics has no local inverse"},
    OracleRow{Oracle::network, "network", "(∂x/∂θ)ᵀ w, through the network alone",
              [](const OracleSizes& of) -> std::int64_t { return of.has_network ? 1 : 0; }, ""},
    OracleRow{Oracle::layer_factors, "layer_factors", "inputs and cotangents of each dense layer",
              // a pullback that keeps what passes
              [](const OracleSizes&) -> std::int64_t { return 1; },
              "the problem has no network of dense layers", false, false},
    OracleRow{Oracle::layer_moments, "layer_moments",
              "second moments of the inputs and cotangents of each convolution",
              // a pullback that sums the squares of what passes
              [](const OracleSizes&) -> std::int64_t { return 1; },
              "the problem has no network of dense layers or convolutions", false, false},
    OracleRow{Oracle::truth, "truth", "the x* that produced y* (extra information)",
              [](const OracleSizes&) -> std::int64_t { return 0; },
              "the problem has no known true x"}};
inline constexpr std::size_t kOracles = kOracleTable.size();

inline constexpr auto kOracleNames = [] {
  std::array<std::string_view, kOracles> names;
  for (std::size_t kind = 0; kind < kOracles; ++kind) names[kind] = kOracleTable[kind].name;
  return names;
}();

constexpr const OracleRow& oracle_row(Oracle oracle) {
  return kOracleTable[static_cast<std::size_t>(oracle)];
}
static_assert([] {
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (kOracleTable[kind].kind != static_cast<Oracle>(kind)) return false;
  return true;
}());

using OracleCounts = std::array<std::int64_t, kOracles>;

inline std::string_view name_of(Oracle oracle) { return oracle_row(oracle).name; }

// A set of oracles: what a method needs, or what a problem offers.
class OracleSet {
 public:
  constexpr OracleSet() = default;
  constexpr OracleSet(std::initializer_list<Oracle> oracles) {
    for (const Oracle oracle : oracles) bits_ |= bit(oracle);
  }
  constexpr bool contains(Oracle oracle) const { return (bits_ & bit(oracle)) != 0; }
  constexpr void add(Oracle oracle) { bits_ |= bit(oracle); }
  constexpr void remove(Oracle oracle) { bits_ &= ~bit(oracle); }
  constexpr bool is_empty() const { return bits_ == 0; }

 private:
  static constexpr unsigned bit(Oracle oracle) { return 1U << static_cast<unsigned>(oracle); }
  unsigned bits_ = 0;
};

// Extra information that a method may use and others do not: a fact of the run, stored by name.

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
