// Which iterations a curve keeps: 0 to 100, then 32 a decade.
#pragma once

#include <cstdint>

namespace isoline {

std::int64_t next_kept_after(std::int64_t iteration);

}  // namespace isoline
