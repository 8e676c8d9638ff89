// Cells that misbehave, run into a folder of their own under limits that are soon reached.
#pragma once

#include <gtest/gtest.h>

#include "benchmarks/run/process_group.h"
#include "benchmarks/run/runner.h"
#include "tests/benchmarks/hostile.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

// A process that has ended, and is reaped by nobody, has no memory.
inline bool lives(pid_t process) {
  const auto figures = figures_of(process);
  return figures && figures->resident_bytes > 0;
}

// A worker that has done this, or was ended.
inline std::unique_ptr<Worker> ended_worker(const std::function<void(Trace&)>& work,
                                            const Limits& limits = {}) {
  auto worker = std::make_unique<Worker>();
  worker->start(work, limits, 1);
  wait_until([&] { return worker->poll(); });
  return worker;
}

class HostileCells : public testing::Test {
 protected:
  HostileCells() { told() = 0; }

  Request hostile(const std::string& misdeed) const {
    return request_for(catalog, "square", {}, "hostile", {{"misdeed", misdeed}});
  }
  Record record_after(const std::string& misdeed) {
    const Request request = hostile(misdeed);
    ran = run_all(catalog, {request}, store, options);
    return record_of(request);
  }
  // In a process of its own, which a test may interrupt, or a cell stop.
  pid_t run_apart(const std::vector<Request>& requests) {
    const pid_t runner = fork();
    if (runner == 0) {
      run_all(catalog, requests, store, options);
      _exit(0);
    }
    return runner;
  }
  // Also of a run that is to be run again.
  Record record_of(const Request& request) const {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "runs"))
      if (entry.path().filename().string().starts_with(request.cell) &&
          entry.path().extension() == ".json")
        return read_record(entry.path());
    ADD_FAILURE() << request.optimizer.spec << " has no record";
    return {};
  }

  Catalog catalog = hostile_catalog();
  TemporaryFolder folder;
  Store store{folder.path()};
  RunOptions options{.limits = {.startup_seconds = 0.5,
                                .hard_seconds = 0.5,
                                .idle_seconds = 2,
                                .memory_bytes = std::int64_t{512} << 20}};
  Outcome ran;
};

}  // namespace isoline::benchmarks
