// The values at which one option of a method is tried on one problem.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

// What tuning sets for a pair of problem and optimizer: the method's tunable option, or that of the
// gradient rule inside its network-optimizer, where the problem has a network to train.
struct Knob {
  std::string option;
  std::string rule;  // the name of that gradient rule; empty: the option is the method's own
  Real standard = 1;
  Range range;
  bool is_whole = false;
  optimizers::Tunable tunable;  // of whose option it is
};

// The knob of a method; nothing where there is nothing to tune. `given` are the options that the
// pair has anyway.
std::optional<Knob> knob_of(const Catalog& catalog, const std::string& optimizer,
                            const Component& problem, const OptionValues& given);
// The same for an option that is named; UsageError where the method has no such number.
Knob knob_named(const Catalog& catalog, const std::string& optimizer, const Component& problem,
                const OptionValues& given, const std::string& option);

// The options of the pair with the knob set.
OptionValues with_value(const Knob& knob, OptionValues given, Real value);

// ‖∇L‖²/‖J∇L‖² at the problem's start, in a process of its own; 1 where it cannot be had.
Real cauchy_step(const Catalog& catalog, const Component& problem);

inline constexpr int kGridValues = 7, kMostExtensions = 3;

// Seven values, ascending, each `factor` times the one before but for the default, which stands in
// the place of the value next to it. `unit` is what the values are multiples of.
std::vector<Real> grid_of(const Knob& knob, Real unit);
// The value beyond the last, or before the first; nothing where the option's range ends.
std::optional<Real> value_beyond(const Knob& knob, const std::vector<Real>& values, bool upward);

// A grid of one's own. "rate=1e-4..1e-1x4": four values from 1e-4 to 1e-1, evenly on a logarithmic
// axis.
struct GivenGrid {
  std::string option = "rate";
  std::vector<Real> values;  // in `unit`
  // "one"; "cauchy": the problem's Cauchy step; or "published": the pair's own value in the tables
  // that are not tuned.
  std::string unit = "one";
};
GivenGrid parse_grid(const std::string& text, const std::string& unit);
std::vector<Real> values_of(const Knob& knob, const GivenGrid& grid, Real unit);

Real three_digits(Real value);  // enough of a rate, and they read well

}  // namespace isoline::benchmarks
