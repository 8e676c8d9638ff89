// The registry's view of a problem: its name, description and options, and how to create it.
// Without Eigen, for code that names problems and does not compute with them.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/foreign/foreign.h"
#include "core/options.h"
#include "core/registry.h"
#include "core/status.h"

namespace isoline::problems {

class Draw;
class Problem;
enum class Inverse;
struct Point;

// Where a problem comes from: columns of tables stand together by it.
enum class Group { other, toy, physics, classical };
inline constexpr std::array<std::string_view, 4> kGroupNames = {"other", "toy", "physics",
                                                                "classical"};
inline std::string_view name_of(Group group) {
  return kGroupNames[static_cast<std::size_t>(group)];
}

struct ProblemEntry {
  std::string name, title;
  Group group = Group::other;
  std::string formula;    // plain text with the mathematical letters of Unicode
  std::string source;     // author, year, equation
  std::string note = {};  // deviations and what a reader should know
  Aim aim = Aim::loss;    // success criterion: a small loss, or the true x
  // Problems that share an operator or its inverse are one witness: tests flip the signs of a
  // family together, and tuning leaves it out as a whole. Empty: the problem is a family of its
  // own.
  std::string family = {};
  bool is_linear = false;  // P(x) = A x + b in its direct mode
  OptionTable options = {};
  // Whether `*` of a suite means it: not where a forward solve takes over a millisecond or an
  // argument is required.
  bool in_all = true;
  // Where its name alone means nothing, how to name one: "process[command=…]". Then in_all is
  // false.
  std::string needs_argument = {};
  std::string file = {};           // that registers it, as the registry saw it
  std::vector<Panel> panels = {};  // plots of its runs
  // The external program, if there is one. Called for every component that is named, so it should
  // cache the answer. UsageError if an argument is missing or the program does not answer.
  std::function<Foreign(const OptionValues& complete_options)> introduce = {};
  std::function<Problem(const OptionValues& complete_options, const Draw&)> make = {};
};
inline const std::string& family_of(const ProblemEntry& entry) {
  return entry.family.empty() ? entry.name : entry.family;
}
using ProblemRegistry = Registry<ProblemEntry>;

void register_problems(ProblemRegistry& registry);  // generated: one call a file
// A component of a shared library (core/foreign/isoline.h), as an entry.
void add_plugin_physics(ProblemRegistry& registry, const PluginComponent& component);

}  // namespace isoline::problems
