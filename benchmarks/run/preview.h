// What a plan would do before it does it: which cells are cached, which cannot exist and why, and
// how long the rest may take.
#pragma once

#include <set>
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

struct Preview {
  std::vector<PreviewedCell> cells;  // one a request, in order
  std::size_t likened = 0;           // settings of problems that were taken to be like another one
};

// Which records count as done.
struct PreviewOptions {
  bool force = false;           // none
  bool reuse = false;           // also those of another build
  std::set<Status> retry = {};  // but those that ended so
};

// Looks into result folders without touching them. Problems are made in processes of their own; of
// a sweep over more settings than can be made in a second, the rest are taken to be like the first.
Preview preview(const Catalog& catalog, const std::vector<Request>& requests,
                const std::filesystem::path& folder, const PreviewOptions& options = {});

}  // namespace isoline::benchmarks
