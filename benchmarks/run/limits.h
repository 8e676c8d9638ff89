// When a process that computes is ended: by its processor time, its wall time, its idleness and its
// memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/process_group.h"
#include "core/records/request.h"
#include "core/records/sheet.h"
#include "core/status.h"

namespace isoline::benchmarks {

// Processor time is that of the complete group, divided by the requested threads. Wall time, five
// times that, protects waiting users. Other load on the machine affects only the second limit.
struct Limits {
  double startup_seconds = 30;   // of processor time, from the fork to the first oracle call
  double hard_seconds = 60;      // of processor time, from the first oracle call
  double idle_seconds = 60;      // with less than 1 % of a core
  bool waits_for_others = true;  // while a process that it started lives it is not idle
  std::int64_t memory_bytes = std::int64_t{4} << 30;

  static constexpr double kWallFactor = 5;
};

// The limit of one request: twice its soft time limit, if it has one; else its suite's; else ten
// times its predicted time, if that is more than the standard.
Limits limits_of(const Request& request, const Limits& standard, double declared_seconds = 0);

// The time for the nominal cost of cells, within their own limits: each unit costs a forward solve,
// as measured in the metadata of a result folder, and a factorizing step about n³ in addition. 0 if
// nothing was measured. Each file is read once.
class DeclaredTimes {
 public:
  DeclaredTimes(const Catalog& catalog, std::filesystem::path folder)
      : catalog_(catalog), folder_(std::move(folder)) {}

  double of(const Request& request);

 private:
  const Catalog& catalog_;
  const std::filesystem::path folder_;
  std::map<std::string, Sheet> sheets_;  // by the problem's spec
};

// The use of a child process, compared with its limits. Time during which this process was stopped
// does not count.
class LimitWatch {
 public:
  struct Breach {
    Status status;  // timeout or memory
    std::string message;
    bool is_idleness = false;
  };

  LimitWatch() = default;
  LimitWatch(const Limits& limits, int threads, std::int64_t now_nanoseconds)
      : limits_(limits), threads_(threads), last_nanoseconds_(now_nanoseconds) {}

  const Limits& limits() const { return limits_; }
  // Whether it is time to look again: each look reads files of the system.
  bool is_due(std::int64_t now_nanoseconds) const;
  std::optional<Breach> check(const ProcessGroup::Usage& usage, bool has_asked_oracle,
                              std::int64_t now_nanoseconds);

 private:
  struct Mark {
    double awake = 0, processor = 0;  // seconds
  };
  std::optional<Breach> check_time(bool has_asked_oracle, const Mark& now);
  bool is_idle(const ProcessGroup::Usage& usage, const Mark& now);

  Limits limits_;
  int threads_ = 1;
  std::int64_t last_nanoseconds_ = 0;
  double awake_ = 0;        // seconds during which this process ran
  bool has_begun_ = false;  // with its first oracle call
  Mark begun_, active_;     // at the first oracle call; when it last did something
};

}  // namespace isoline::benchmarks
