// Which subject of NEW answers which of BASE, and which options and build parts differ.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "reports/compare/subject.h"

namespace isoline::reports {

inline constexpr const char* kAllowedSchema = "isoline.allowed/1";

// Patterns hold for a name, or for a specification as asked or as given; '*' stands for any text.
struct AllowedCells {
  std::string problem = "*", optimizer = "*", reason;
};
using AllowedList = std::vector<AllowedCells>;

AllowedList allowed_from_json(const Json& json);  // UsageError where it is no such list
AllowedList read_allowed(const std::filesystem::path& file);

// The first entry that names the subject; the list's end where none does.
AllowedList::const_iterator entry_for(const AllowedList& list, const Subject& subject);

bool matches(std::string_view pattern, std::string_view text);

// Which subject of NEW answers which of BASE, and which options and build parts differ.

struct Pairs {
  std::vector<std::pair<const Subject*, const Subject*>> both;  // in the order of BASE
  std::vector<const Subject*> only_before, only_after;
};

// By their keys; then by what was asked, as typed, with its seed and budget, since a changed
// default or rate changes the key; then by the options given. What two of a side have in common
// pairs neither. The subjects must outlive the pairs.
Pairs paired(const std::vector<Subject>& before, const std::vector<Subject>& after);

// What differs between paired subjects before any figure does: what they were given, and which
// parts of the program computed them.

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
