// Words as a shell reads them.
#pragma once

#include <string>
#include <string_view>

namespace isoline {

// The word itself where it is plain, else in quotes that keep it whole.
std::string shell_word(std::string_view word);

}  // namespace isoline
