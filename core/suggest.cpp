// Edit distance, and the sentence about an unknown name.
#include "core/suggest.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace isoline {
namespace {

// Levenshtein (1966): least number of letters inserted, deleted or replaced.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view wrong, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, wrong.size() / 3) + 1;
  for (const std::string& name : known) {
    const bool begins = wrong.size() >= 2 && name.starts_with(wrong);
    const std::size_t distance = begins ? 1 : edit_distance(wrong, name);
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

std::string unknown_name(std::string_view what, std::string_view wrong,
                         const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(wrong, known);
  if (!nearest.empty())
    return fmt::format("unknown {} '{}'; did you mean '{}'?", what, wrong, nearest);
  constexpr std::size_t kMostListed = 20;
  if (known.size() > kMostListed)
    return fmt::format("unknown {} '{}', which is like none of the {} that are known", what, wrong,
                       known.size());
  return fmt::format("unknown {} '{}'; known: {}", what, wrong, fmt::join(known, ", "));
}

}  // namespace isoline
