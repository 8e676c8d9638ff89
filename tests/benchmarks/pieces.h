// Physics given by functions; and a run that is stopped and continued after every step until it
// ends by itself.
#pragma once

#include <gtest/gtest.h>

#include <csignal>

#include "benchmarks/run/execute.h"
#include "problems/dense_physics.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

// y = P(x), (k) -> (m), with its Jacobian (m, k).
template <class Value, class Derivative>
std::unique_ptr<problems::Physics> physics_of(Index k, Index m, Value value, Derivative J) {
  class Plain final : public problems::DensePhysics {
   public:
    Plain(Index inputs, Index outputs, Value of_x, Derivative slopes)
        : DensePhysics(inputs, outputs), value_(of_x), slopes_(slopes) {}
    void value(VectorRef x, VectorOut y) const override { y = value_(x); }
    void derivative(VectorRef x, BatchOut out) const override { out = slopes_(x); }

   private:
    Value value_;
    Derivative slopes_;
  };
  return std::make_unique<Plain>(k, m, value, J);
}

inline Record executed(const Catalog& catalog, const Request& request, Checkpoint checkpoint = {},
                       bool keeps_spectra = false) {
  const auto trace = std::make_unique<Trace>();  // too large for a stack
  trace->wants_spectra = keeps_spectra;
  execute(catalog, request, *trace, std::move(checkpoint));
  return record_of(request, *trace);
}

inline Record executed_in_pieces(const Catalog& catalog, const Request& request,
                                 bool keeps_spectra = false) {
  constexpr int kMost = 100;
  const TemporaryFolder folder;
  for (int pieces = 1; pieces <= kMost; ++pieces) {
    Checkpoint checkpoint(folder.path() / "state", "cell", 0);
    std::raise(SIGTERM);
    Record record = executed(catalog, request, std::move(checkpoint), keeps_spectra);
    if (record.status == Status::interrupted) continue;
    EXPECT_GT(pieces, 3);
    return record;
  }
  ADD_FAILURE() << "it does not end";
  return {};
}

}  // namespace isoline::benchmarks
