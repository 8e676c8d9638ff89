// A result folder of which one cell may differ from that of another: what the gate is tried on.
#pragma once

#include <cstdint>
#include <functional>

#include "tests/reports/fixture.h"

namespace isoline::reports {

// Twelve cells, of which cell 5 is what `change` makes of it.
inline void fill(const ResultFolder& folder, const std::function<void(Record&)>& change) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Record record = record_of({.seed = seed, .hits = 20 + seed, .status = Status::budget});
    record.repeat_wall_seconds = {0.1, 0.2};
    if (seed == 5) change(record);
    folder.add(record);
  }
}

}  // namespace isoline::reports
