// The files beside the records in a result folder: metadata for each component used.
//
//   OUT/plan.json              the planned matrix, stored before the first run
//   OUT/runs/CELL-BUILD.json   the records
//   OUT/components/*.json      the component metadata
//   OUT/report/                the output of `isoline report`
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
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
  std::string family;                   // of an optimizer: its group by required oracles
  std::string mathematics;              // of an optimizer: the kind of its step
  std::string group;                    // of a problem: toy, physics, classical
  std::string tunable;                  // of an optimizer: the option that tuning chooses, if any
  std::string inverse;                  // of a problem: none, exact, damped, estimate, approximate
  Index unknowns = 0, residuals = 0;    // of a problem
  std::optional<Aim> aim;               // of a problem: the success criterion
  // For a direct problem with a small J (residuals, unknowns): σ_max / σ_min of J at the standard
  // start and, if known, at the solution; infinite if J is rank-deficient.
  std::optional<Real> start_condition, condition;
  std::optional<Landscape> landscape_x, landscape_y;  // of a problem with two unknowns, two outputs
  std::vector<Real> target;                           // y*, where small
  std::vector<Real> truth;                            // x*, where small and known
  std::optional<Field> field;                         // of a problem on a grid: what x and y are
  std::vector<Panel> panels;                          // of a problem: the figures of its paper
  std::optional<MeasuredPrices> prices;               // of a problem

  std::string file_name() const;
};

inline constexpr const char* kSheetSchema = "isoline.component/1";

Json to_json(const Sheet& sheet);
Sheet sheet_from_json(const Json& json);  // UsageError if it is not valid
Sheet sheet_from_text(const std::string& text, const std::string& origin);

Json sheet_schema();  // what benchmarks/schemas/component.json holds

}  // namespace isoline
