// Numbers in the texts of UM-Bridge. They are written in the fewest digits that read back as the
// same bits. What is not finite is data: it is written as Python's json does, NaN, Infinity and
// -Infinity, and read in any spelling, null among them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/json.h"
#include "core/real.h"

namespace isoline {

using Numbers = std::vector<Real>;

void append_number(std::string& out, Real value);
void append_numbers(std::string& out, const Numbers& values);
void append_vectors(std::string& out, const std::vector<Numbers>& vectors);

// The tree of a text whose numbers may be no JSON, by its origin's name in a UsageError; and the
// numbers of a list in it.
Json bridge_json(std::string_view text, const std::string& origin);
Numbers numbers_of(const Json& list);

}  // namespace isoline
