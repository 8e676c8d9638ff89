// The measured properties of each optimizer, and their file: OUT/audit.json, schema
// isoline.audit/1.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/real.h"

namespace isoline {

using Json = nlohmann::json;

inline constexpr Real kUnknown = std::numeric_limits<Real>::quiet_NaN();
inline constexpr Real kMostLawResidual = 0.01;     // above, there is no power law
inline constexpr Real kMostOrderResidual = 0.5;    // above, convergence is irregular
inline constexpr Real kInvariantDeviation = 1e-9;  // a path that deviates less has not changed

// value ∝ scaleᵖ, fitted by least squares in decades.
struct PowerLaw {
  std::vector<Real> values;  // one a scale; not-a-number where there was no step
  Real exponent = kUnknown;
  Real residual = kUnknown;  // root mean square, in decades
  bool has_values() const;   // any step at all
  bool holds() const { return residual <= kMostLawResidual; }
};

// The first step and what it changes of the loss to first order, |∇Lᵀ Δx|, under one scaling.
struct ScalingLaw {
  std::vector<Real> scales;
  PowerLaw step, loss_change;
};
inline constexpr std::array<std::string_view, 4> kScalingNames = {"loss", "output", "input",
                                                                  "slope"};
enum class Scaled { loss, output, input, slope };

inline constexpr std::array<std::string_view, 6> kChangeNames = {
    "x_diagonal", "x_rotated", "x_affine", "y_diagonal", "y_rotated", "y_affine"};

// Errors eᵢ = ‖xᵢ − x*‖ of one run, log eᵢ₊₁ = order · log eᵢ + … by least squares.
struct Approach {
  Real order = kUnknown, residual = kUnknown;  // residual in decades
  Real remaining = kUnknown;                   // the last error over the first
  std::int64_t steps = 0;                      // until rounding, or until it ended
  bool is_exact = false;                       // ends within rounding of x*
};

struct AuditedOptimizer {
  std::string name, spec;
  std::string reason;   // why nothing was measured; empty if something was
  std::string network;  // it was taught to, where θ = x makes no sense; else empty
  std::array<ScalingLaw, kScalingNames.size()> scalings;
  std::array<Real, kChangeNames.size()> deviations{};     // of the path, relative to its extent
  Approach regular, singular;                             // J regular, or singular, at x*
  Real linear_angle = kUnknown, curved_angle = kUnknown;  // degrees, by the stage before
  std::vector<std::string> declared;                      // oracles
  std::map<std::string, std::int64_t> counted;            // by oracle
  std::int64_t iterations = 0;                            // in which they were counted
  std::vector<std::string> flags;  // what was declared otherwise than it was measured

  const ScalingLaw& law(Scaled scaled) const { return scalings[static_cast<std::size_t>(scaled)]; }
};

Json to_json(const AuditedOptimizer& audited);
AuditedOptimizer audited_from_json(const Json& json);

// The whole file.
Json audit_to_json(const std::vector<AuditedOptimizer>& all);
std::vector<AuditedOptimizer> audit_from_json(const Json& json);

}  // namespace isoline
