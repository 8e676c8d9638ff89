// A part of a record beyond its curve: parts/NAME.h declares one as its first struct, with its
// data, fields(), what must hold of it (require_sound), and
//
//   static constexpr Part kPart{.member = "spectrum"};
//
// From these follow its place in `Parts`, which every record has, its JSON and its schema. A
// keeper, benchmarks/run/keepers/NAME.cpp, fills it.
#pragma once

#include <type_traits>

namespace isoline {

template <class Given, class Type>
concept Like = std::is_same_v<std::remove_const_t<Given>, Type>;

struct Part {
  const char* member;        // its name in the record
  const char* law = "";      // more of its schema
  const char* ignored = "";  // its member that may differ between two runs of one build; "*": all
};

inline constexpr const char *kCountLaw = R"({"minimum": 0})",
                            *kDigestLaw = R"({"pattern": "^[0-9a-f]{16}$"})";

}  // namespace isoline
