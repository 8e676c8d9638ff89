// A matrix run into a folder of its own, for tests that read what it leaves behind.
#pragma once

#include <gtest/gtest.h>

#include "benchmarks/plan/suite.h"
#include "benchmarks/run/runner.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

struct FinishedMatrix {
  FinishedMatrix(const Catalog& catalog, const Suite& suite, const Rates& rates)
      : FinishedMatrix(catalog, expand(catalog, suite, rates)) {}
  FinishedMatrix(const Catalog& catalog, std::vector<Request> asked)
      : requests(std::move(asked)), store(folder.path()) {
    outcome = run_all(catalog, requests, store, {.jobs = 2});
    for (const Request& request : requests) {
      const auto record = store.find(request);
      EXPECT_TRUE(record.has_value()) << request.problem.spec << " × " << request.optimizer.spec;
      if (record) records.push_back(*record);
    }
  }

  TemporaryFolder folder;
  std::vector<Request> requests;
  Store store;
  Outcome outcome;
  std::vector<Record> records;  // one a request, in order
};

inline std::string title_of(const Record& record) {
  return record.request.problem.spec + " × " + record.request.optimizer.spec;
}

}  // namespace isoline::benchmarks
