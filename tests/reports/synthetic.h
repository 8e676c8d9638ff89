// Generates result folders of any size from a seed, to test reports of a hundred thousand records.
#pragma once

#include <filesystem>

#include "core/records/record.h"

namespace isoline::reports {

// Every problem is given to every optimizer with every seed.
struct SyntheticSize {
  std::size_t problems = 100, optimizers = 50, seeds = 20;
  std::size_t points = 64;        // of every curve, in 12 columns
  std::uint64_t random_seed = 0;  // of all that is drawn
  bool is_sample = false;  // with measured prices, landscapes and paths, and some cells missing

  std::size_t records() const { return problems * optimizers * seeds; }
};

// As a run would have left it: request with options, curve, hits where a minimum is declared,
// summary and full provenance. One in a hundred went wrong, and some pairs do not apply.
Record synthetic_record(const SyntheticSize& size, std::size_t index);  // in [0, size.records())

// The plan, the sheets and all records. Without a flush of each file.
void write_synthetic_study(const std::filesystem::path& folder, const SyntheticSize& size);

}  // namespace isoline::reports
