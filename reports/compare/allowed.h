// Cells that NEW may lack: a list that stands in the tree, each entry with its reason.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
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

}  // namespace isoline::reports
