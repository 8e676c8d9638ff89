// The files beside the records in a result folder: metadata for each component used, and the
// measured properties of each optimizer.
//
//   OUT/plan.json              the planned matrix, stored before the first run
//   OUT/runs/CELL-BUILD.json   the records
//   OUT/components/*.json      the component metadata
//   OUT/audit.json             the measured properties of optimizers
//   OUT/report/                the output of `isoline report`
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/real.h"
#include "core/status.h"

namespace isoline {

using Json = nlohmann::json;

// The loss of a two-dimensional problem on a grid: value(i, j) at the i-th x1 and the j-th x2.
struct Landscape {
  std::array<Real, 4> window{};  // x1 low, x1 high, x2 low, x2 high; both ends are grid points
  Grid loss;                     // (n1, n2)
  // How its contours are spaced: "logarithm", "fifth root" or "powers of two", 2⁻⁵ to 2⁷.
  std::string spacing = "logarithm";
};

// The cost of one oracle call, in forward solves: the first at a new point.
struct MeasuredPrice {
  std::string oracle;
  std::int64_t declared = 0;
  Real price = 0, low = 0, high = 0;  // the median of the rounds, and their middle 80 %
  std::int64_t rounds = 0, calls = 0;
  bool resolved = true;  // else overhead and noise: the declared one says more
};

// The row of a learned problem that is no oracle: what its network alone takes, an example.
inline constexpr const char* kInference = "inference";

// Measured at the published instance of a problem, while nothing else runs.
struct MeasuredPrices {
  std::string build, processor;  // of the program and the machine that measured
  Real forward_seconds = 0;      // the median
  std::vector<MeasuredPrice> oracles;
};

// Schema isoline.component/1: what a reader of the report needs to know of a problem or optimizer.
struct Sheet {
  std::string kind;  // "problem" or "optimizer"
  std::string name, spec, title, formula, source, note;
  std::string options_text;             // describe_options() as JSON text
  std::vector<std::string> oracles;     // offered by a problem, required by an optimizer
  std::vector<std::string> privileges;  // of an optimizer
  // The group of an optimizer by required oracles; the problems that share an operator.
  std::string family;
  std::string mathematics;            // of an optimizer: the kind of its step
  std::string group;                  // of a problem: toy, physics, classical
  std::string tunable;                // of an optimizer: the option that tuning chooses, if any
  std::string inverse;                // of a problem: none, exact, damped, estimate, approximate
  bool linear = false;                // of a problem: P(x) = A x + b
  Index unknowns = 0, residuals = 0;  // of a problem
  std::optional<Aim> aim;             // of a problem: the success criterion
  // For a direct problem with a small J (residuals, unknowns): σ_max / σ_min of J at the standard
  // start and, if known, at the solution; infinite if J is rank-deficient.
  std::optional<Real> start_condition, condition;
  std::optional<Landscape> landscape_x, landscape_y;  // of a problem with two unknowns, two outputs
  std::vector<Real> target;                           // y*, where small
  std::vector<Real> truth;                            // x*, where small and known
  std::optional<Field> field;                         // of a problem on a grid: what x and y are
  std::vector<Panel> panels;                          // of a problem: the figures of its paper
  std::optional<MeasuredPrices> prices;               // of a problem
  std::string certified;  // of another program's problem: the build that passed its checks

  std::string file_name() const;
};

Json to_json(const Sheet& sheet);
std::string file_text(const Sheet& sheet);
Sheet sheet_from_json(const Json& json);  // UsageError if it is not valid
Sheet sheet_from_text(const std::string& text, const std::string& origin);

Json sheet_schema();  // what benchmarks/schemas/component.json holds

// Schema isoline.audit/1: the measured properties of each optimizer.

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

// A cell of the table of conduct: whether the rule of its column holds, the figures beside the
// mark, and the files of the records that they are from.
struct ConductCell {
  std::string column;         // "own counter"
  std::optional<bool> holds;  // empty: the column does not apply, and the figures say why
  std::string figures;
  std::vector<std::string> records;
};

struct AuditedOptimizer {
  std::string name, spec;
  std::vector<ConductCell> conduct;  // in the order of the columns; empty: it was not measured
  std::string reason;                // why nothing was measured; empty if something was
  std::string network;               // it was taught to, where θ = x makes no sense; else empty
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
AuditedOptimizer audited_from_text(const std::string& text, const std::string& origin);

// The whole file.
Json audit_to_json(const std::vector<AuditedOptimizer>& all);
std::vector<AuditedOptimizer> audit_from_text(const std::string& text, const std::string& origin);

}  // namespace isoline
