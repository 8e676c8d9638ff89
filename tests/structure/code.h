// Source text as code: without comments and strings, as statements, as definitions of types.
#pragma once

#include <string>
#include <vector>

#include "tests/structure/sources.h"

namespace isoline {

// Comments, directives and what stands between quotes are left out; every line stays where it was.
std::string code_of(const std::string& text);

struct Type {
  std::string name;  // isoline::reports::Point; of a nested one the outer alone is listed
  std::size_t line;
  bool is_anonymous;
  bool is_defined;  // or only declared
};

// Types at namespace scope, which clang-format puts at the beginning of a line.
std::vector<Type> types_of(const Source& source);

}  // namespace isoline
