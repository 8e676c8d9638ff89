// A run that is stopped after every step and gone on with, until it has ended by itself.
#pragma once

#include <gtest/gtest.h>

#include <csignal>

#include "benchmarks/run/execute.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

inline Record executed(const Catalog& catalog, const Request& request, Checkpoint checkpoint = {},
                       bool keeps_spectra = false) {
  const auto trace = std::make_unique<Trace>();  // too large for a stack
  trace->spectra.are_wanted = keeps_spectra;
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
