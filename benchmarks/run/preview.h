// What a plan would do before it does it: which cells are cached, which cannot exist and why, and
// how long the rest may take.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/store.h"

namespace isoline::benchmarks {

struct PreviewedCell {
  const Request* request;
  bool is_cached = false;
  std::string why_inapplicable;  // empty: it can run
  double seconds = 0;            // estimate, where it would run
};

// Looks into result folders without touching them; with `reuse` a cell that another build has done
// is cached too. Problems are made in processes of their own.
std::vector<PreviewedCell> preview(const Catalog& catalog, const std::vector<Request>& requests,
                                   const std::filesystem::path& folder, bool reuse = false);

}  // namespace isoline::benchmarks
