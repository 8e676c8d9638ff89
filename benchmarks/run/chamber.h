// What a judge does in its own process.
#pragma once

#include <cstdint>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/judge.h"

namespace isoline::benchmarks {

// Messages of the socket between a run and its judge.
struct PointToJudge {
  std::size_t slot;
  std::uint64_t seed;
  int threads;
};

struct JudgesReply {
  std::size_t slot;
  bool is_judged;
  Judged judged;
  char failure[Trace::kText];
};

// Answers what comes by the socket, about points that the workers returned, until nobody asks any
// more. Never returns.
[[noreturn]] void judge_points(const Catalog& catalog, const Component& problem,
                               const std::vector<Worker>& workers, int socket);

}  // namespace isoline::benchmarks
