// What our source files include, directly and through one another.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/structure/sources.h"

namespace isoline {

struct Include {
  std::string name;
  bool is_quoted;
};

std::vector<Include> includes_of(const Source& source);

// How a source reaches a header of a library whose name begins so: the source, headers of ours,
// then that header; nothing where it does not. The shortest way counts.
std::optional<std::vector<std::string>> way_to(const Source& source, const std::string& header);

}  // namespace isoline
