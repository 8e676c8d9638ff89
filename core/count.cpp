// Counts as they are read: in groups of three digits.
#include "core/count.h"

namespace isoline {

std::string count_text(std::uint64_t count) {
  if (count == kUncountable) return "more than 10^19";
  std::string text = std::to_string(count);
  constexpr std::size_t kGroup = 3;
  for (std::size_t at = text.size(); at > kGroup; at -= kGroup) text.insert(at - kGroup, ",");
  return text;
}

}  // namespace isoline
