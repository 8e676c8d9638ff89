// The registry's view of an optimizer: its name, description, needs and options, and how to create
// it. Without Eigen, for code that names optimizers and does not run them.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/foreign/foreign.h"
#include "core/options.h"
#include "core/oracle.h"
#include "core/registry.h"
#include "problems/problem_entry.h"

namespace isoline::optimizers {

using problems::Problem;

class Descent;
class Meter;
class Optimizer;

enum class Family {
  first_order,
  curvature,
  inversion,
  ceres,
  nlopt,
  nlopt_derivative_free,
  minpack,
  gsl,
  libdogleg,
  foreign
};
inline constexpr std::array<std::string_view, 10> kFamilyNames = {
    "first-order",           "curvature", "inversion", "ceres",     "nlopt",
    "nlopt-derivative-free", "minpack",   "gsl",       "libdogleg", "foreign"};
inline std::string_view name_of(Family family) {
  return kFamilyNames[static_cast<std::size_t>(family)];
}

// The kind of a step by its mathematics, not by its library: charts use it for colours.
enum class Kind {
  other,
  gradient,         // along ∇L, with momentum, a line search or a separable model
  adaptive,         // ∇L over its own history, component by component
  quasi_newton,     // curvature from differences of ∇L
  second_order,     // curvature from H, or products with it, or factors of it
  least_squares,    // Jᵀ J instead of H: Gauss-Newton and Levenberg-Marquardt
  half_inverse,     // a root of J's singular values
  inversion,        // the physics inverted, exactly or step by step
  derivative_free,  // losses alone
};
inline constexpr std::array<std::string_view, 9> kKindNames = {
    "other",         "gradient",     "adaptive",  "quasi-newton",   "second-order",
    "least-squares", "half-inverse", "inversion", "derivative-free"};
inline std::string_view name_of(Kind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

// The one option of a method that tuning chooses. A grid has the default, so many values below it
// and the rest above, each `factor` times the one before.
struct Tunable {
  enum class Unit {
    option,  // the default itself
    cauchy,  // ‖∇L‖²/‖J∇L‖² at a problem's start, for steps along ∇L, which have no other unit of
  };
  std::string option = {};  // empty: there is nothing to tune
  int below = 3;
  Real factor = 3.1622776601683795;  // half a decade
  Unit unit = Unit::option;
};

struct OptimizerEntry;
using OptimizerRegistry = Registry<OptimizerEntry>;

struct OptimizerEntry {
  std::string name, title;
  Family family = Family::first_order;
  Kind kind = Kind::other;
  std::string formula;    // of the update, plain text with the mathematical letters of Unicode
  std::string source;     // author, year, equation
  std::string note = {};  // deviations and what a reader should know
  OracleSet needs = {};
  // The path in y does not change when x is rescaled, componentwise and linearly.
  bool is_input_scale_invariant = false;
  // Compares losses from step to step, so that fresh samples at each step would mislead it.
  bool needs_same_samples = false;
  // Its iterates respect the bounds of a problem, which it asks the meter for.
  bool keeps_bounds = false;
  // Above these the cell is inapplicable: n, and min(n, m·B) where J is factorized whole.
  Index most_unknowns = std::numeric_limits<Index>::max();
  Index most_rank = std::numeric_limits<Index>::max();
  OptionTable options = {};
  Tunable tunable = {};
  // Whether `*` of a suite means it: not where an argument is required, nor what is a variant of
  // another for one experiment or a peer for few problems.
  bool in_all = true;
  // As for a problem: how to name it where the name alone is incomplete, and the external program,
  // if there is one.
  std::string needs_argument = {};
  std::function<Foreign(const OptionValues& complete_options)> introduce = {};
  std::string file = {};  // that registers it, as the registry saw it
  // All it needs, where that depends on the options or the problem; `needs` is then the least.
  std::function<OracleSet(const OptionValues& options, const Problem&)> needs_for = {};
  // Specs of the optimizers that step inside it, on a direct problem or where it learns.
  std::function<std::vector<std::string>(const OptionValues& options, bool is_learning)> inside =
      {};
  // Any further reason why this pair makes no sense; empty if it does.
  std::function<std::string(const OptionValues& options, const Problem&)> objection = {};
  std::function<std::unique_ptr<Optimizer>(const OptionValues& options, const OptimizerRegistry&)>
      make = {};
  std::function<std::unique_ptr<Descent>(const OptionValues& options)> make_descent =
      {};  // gradient rules
};

void register_optimizers(OptimizerRegistry& registry);  // generated: one call a file
// A component of a shared library (core/foreign/isoline.h), as an entry.
void add_plugin_method(OptimizerRegistry& registry, const PluginComponent& component);

}  // namespace isoline::optimizers
