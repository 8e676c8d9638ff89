// "Did you mean": the known name nearest to a misspelt one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace isoline {

// Nearest by edit distance, if near enough to be meant; else empty.
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& known);

// "unknown WHAT 'wrong'; did you mean 'right'?", or the list of what is known.
std::string unknown_name(std::string_view what, std::string_view wrong,
                         const std::vector<std::string>& known);

}  // namespace isoline
