// Which cell of NEW answers which of BASE, what NEW may lack, and which options and build parts
// differ.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "reports/compare/cells.h"

namespace isoline::reports {

inline constexpr const char* kAllowedSchema = "isoline.allowed/1";

// Patterns hold for a name, or for a specification as asked or as given; '*' stands for any text.
struct AllowedCells {
  std::string problem = "*", optimizer = "*", reason;
  bool is_of_criterion =
      false;  // NEW may judge success by another criterion; else it may lack them
};
using AllowedList = std::vector<AllowedCells>;

AllowedList allowed_from_json(const Json& json);  // UsageError where it is no such list
AllowedList read_allowed(const std::filesystem::path& file);

// The first entry of its kind that names the cell; the list's end where none does.
AllowedList::const_iterator entry_for(const AllowedList& list, const ComparedCell& cell,
                                      bool is_of_criterion);

bool matches(const std::string& pattern, const std::string& text);

struct Pairs {
  std::vector<std::pair<const ComparedCell*, const ComparedCell*>> both;  // in the order of BASE
  std::vector<const ComparedCell*> only_before, only_after;
};

// By their keys; then by what was asked, as typed, with its seed and budget, since a changed
// default or rate changes the key; then by the options given; at last by what was asked and the
// seed, with another budget or other threads. What two of a side have in common pairs neither. The
// cells must outlive the pairs.
Pairs paired(const std::vector<ComparedCell>& before, const std::vector<ComparedCell>& after);

// "iterations 20 → 30": what differs between the terms of two cells.
std::string change_of_terms(const ComparedCell& before, const ComparedCell& after);

// Differences between paired cells before any value differs. For options "adam: default of epsilon
// 1e-8 → 0.01"; for the build "another harness".
std::set<std::string> changed_options(const ComparedCell& before, const ComparedCell& after);
std::vector<std::string> changed_parts(const ComparedCell& before, const ComparedCell& after);

// Why the two of a pair may differ: both of these, or that nothing of them explains it.
std::string cause_of(const ComparedCell& before, const ComparedCell& after);

}  // namespace isoline::reports
