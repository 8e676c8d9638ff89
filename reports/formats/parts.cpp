// How wide tables are taken apart.
#include <algorithm>

#include "reports/formats/formats.h"

namespace isoline::reports {

std::vector<Part> parts_of(const Table& table, std::size_t most) {
  std::vector<Part> parts;
  std::size_t at = table.names;
  for (const std::size_t count : table.parts) {
    parts.push_back({at, at + count});
    at += count;
  }
  const std::size_t rest = table.columns.size() - at;
  // As many a part as divides them evenly: 20 columns are 7, 7 and 6.
  const std::size_t pieces = (rest + most - 1) / most;
  const std::size_t each = pieces == 0 ? 0 : (rest + pieces - 1) / pieces;
  for (; at < table.columns.size(); at += each)
    parts.push_back({at, std::min(at + each, table.columns.size())});
  return parts;
}

}  // namespace isoline::reports
