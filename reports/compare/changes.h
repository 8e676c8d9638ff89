// What differs between paired subjects before any figure does: what they were given, and which
// parts of the program computed them.
#pragma once

#include <string>
#include <vector>

#include "reports/compare/pairing.h"

namespace isoline::reports {

// "levenberg-marquardt: default of initial-damping 1e-4 → 1e4 (51 cells)", a line a change.
std::vector<std::string> changed_settings(const Pairs& pairs);

// "another optimizer: adam, gd (51 cells)", a line a part of the build, the widest first.
std::vector<std::string> changed_builds(const Pairs& pairs);

// Why the two of a pair may differ: "adam: default of epsilon 1e-8 → 0.01, another harness", or
// that nothing of what was given or computed explains it.
std::string cause_of(const Subject& before, const Subject& after);

// The names, a dozen of them at most, and how many more there are.
std::string names_text(const std::vector<std::string>& names);

}  // namespace isoline::reports
