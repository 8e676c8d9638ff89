// A digest in the form that names files.
#include "core/digest.h"

#include <fmt/format.h>

namespace isoline {

std::string digest(std::string_view text) { return fmt::format("{:016x}", fnv1a(text)); }

}  // namespace isoline
