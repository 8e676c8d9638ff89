// Compressed bytes, by zlib.
#pragma once

#include <string>
#include <string_view>

namespace isoline {

// In the format of zlib (RFC 1950), which browsers read.
std::string compressed(std::string_view bytes);

}  // namespace isoline
