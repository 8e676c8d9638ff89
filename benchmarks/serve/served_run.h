// A problem that others ask, one evaluation at a time, under the meter of any run: whoever asks is
// the method, each new best evaluation an iteration, and what comes of it a trace like another's.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "benchmarks/plan/catalog.h"
#include "core/records/record.h"
#include "core/trace.h"

namespace isoline::benchmarks {

using optimizers::Linearization;

class ServedRun {
 public:
  // UsageError where the problem learns, or holds several samples.
  ServedRun(const Catalog& catalog, Request request);

  const Request& request() const { return request_; }
  const Problem& problem() const { return problem_; }

  // The forward pass at an x, (k), counted unless it is that of the last call.
  Linearization& at(VectorRef x);

  // What has been asked until it reached its target, spent its budget, or now; nothing where nobody
  // asked. Whoever goes on asking is answered, and counts no more.
  std::optional<Record> record();

 private:
  void begin();
  void take(VectorRef x, Real loss);
  void end(Status verdict);

  const Request request_;
  Problem problem_;
  std::unique_ptr<Trace> trace_;  // too large for a stack
  Meter meter_;
  Linearization at_;
  Vector x_, best_;  // (k); x_ empty before the first call
  Real best_loss_ = 0;
  std::int64_t begun_ = 0, asked_ = 0;  // monotonic nanoseconds: of the first call and of the last
  RunProvenance provenance_;
  std::optional<Record> record_;
};

}  // namespace isoline::benchmarks
