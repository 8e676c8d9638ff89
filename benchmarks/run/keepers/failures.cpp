// Failed evaluations, which the trace has, since they may end a run.
#include "benchmarks/run/keepers/keeper.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

struct AllFailures {
  void write(const Trace& trace, Parts& parts) const {
    const FailedEvaluations& kept = trace.failures;
    if (kept.total == 0) return;
    Failures& failures = parts.failures.emplace(Failures{.total = kept.total});
    for (int i = 0; i < kept.kept; ++i) {
      failures.x.emplace_back(kept.point(i).begin(), kept.point(i).end());
      failures.reasons.push_back(valid_utf8(kept.reason[i]));
    }
  }
};

}  // namespace

Keeper failures_keeper() { return keeper_of<AllFailures>(); }

}  // namespace isoline::benchmarks
