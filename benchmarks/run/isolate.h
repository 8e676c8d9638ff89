// Runs in other processes, which cannot harm this one: each in its own, or one after the other in a
// process that stays. Limits of processor time, wall time, idle time and memory end them.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/process_group.h"
#include "core/records/request.h"
#include "core/records/sheet.h"
#include "core/status.h"
#include "core/trace.h"

namespace isoline::benchmarks {

// Processor time is that of the complete group, divided by the requested threads. Wall time, five
// times that, protects waiting users: other load on the machine affects it alone.
struct Limits {
  double startup_seconds = 30;   // of processor time, from the fork to the first oracle call
  double hard_seconds = 60;      // of processor time, from the first oracle call
  double idle_seconds = 60;      // with less than 1 % of a core
  bool waits_for_others = true;  // while a process that it started lives it is not idle
  std::int64_t memory_bytes = std::int64_t{4} << 30;

  static constexpr double kWallFactor = 5;
};

inline constexpr int kLookMilliseconds = 20;  // how often limits and output are looked at

// The limit of one request: twice its soft time limit, if it has one; else its suite's; else ten
// times its predicted time, if that is more than the standard.
Limits limits_of(const Request& request, const Limits& standard, double declared_seconds = 0);

// The time for the nominal cost of cells: each unit costs a forward solve, as measured in the
// metadata of a result folder, and a factorizing step about n³ in addition. 0 if not measured.
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
  // The processor time before this work was spent on earlier work.
  LimitWatch(const Limits& limits, int threads, std::int64_t now_nanoseconds,
             double processor_seconds_before = 0)
      : limits_(limits),
        threads_(threads),
        last_nanoseconds_(now_nanoseconds),
        before_(processor_seconds_before) {}

  const Limits& limits() const { return limits_; }
  // Whether it is time to look again: each look reads files of the system.
  bool is_due(std::int64_t now_nanoseconds) const {
    return now_nanoseconds - last_nanoseconds_ >= kLookMilliseconds * std::int64_t{1'000'000};
  }
  std::optional<Breach> check(const ProcessGroup::Usage& usage, bool has_asked_oracle,
                              std::int64_t now_nanoseconds);

 private:
  struct Mark {
    double awake = 0, processor = 0, waiting = 0;  // seconds
  };

  Limits limits_;
  int threads_ = 1;
  std::int64_t last_nanoseconds_ = 0;
  double before_ = 0;       // seconds of processor time
  double awake_ = 0;        // seconds during which this process ran
  bool has_begun_ = false;  // with its first oracle call
  Mark begun_, active_;     // at the first oracle call; when it last did something
};

// The θ that a cell returns, in memory shared with its verifier.
struct Returned {
  static constexpr std::int64_t kMost = std::int64_t{1} << 23;

  std::atomic<std::int64_t> size{0};  // 0: nothing was returned, or more than fits
  double theta[kMost];                // (n)
};

// Captures the output of a child process, so that no terminal gets it, and keeps a bounded part.
class CapturedOutput {
 public:
  static constexpr std::size_t kMost = std::size_t{64} << 10;  // bytes kept, from the first on

  CapturedOutput() = default;
  ~CapturedOutput() { close(); }
  CapturedOutput(const CapturedOutput&) = delete;
  CapturedOutput& operator=(const CapturedOutput&) = delete;

  void open();             // before the child is forked
  void begin();            // forgets what has come
  void redirect() const;   // in the child
  void close_child_end();  // in the parent, once the child is forked
  void drain();            // takes what has come; what stays in the pipe holds the writer up
  void close();

  std::string text() const;        // valid UTF-8; says how much was left out
  std::string last_words() const;  // the last line that says something, cut to some 200 bytes

 private:
  int read_end_ = -1, write_end_ = -1;
  bool is_widened_ = false;
  std::string kept_, tail_;
  std::size_t left_out_ = 0;  // bytes
};

// Its trace lives in shared memory and outlives the child. Until the child has ended it may hold
// anything; then it is checked whole, and what is read of it is sound.
class Worker {
 public:
  Worker();
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void start(const std::function<void(Trace&)>& work, const Limits& limits, int threads);
  // Keeps a child ready, which runs the requests that it is handed, one after the other. It ends
  // with the first that ends badly, and with the one that leaves processes behind.
  void keep_ready(const std::function<void(const Request&, Trace&)>& work, int threads);
  bool is_ready() const { return channel_ >= 0 && !is_running_; }
  void hand_over(const Request& request, const Limits& limits);  // made before keep_ready()
  void retire();
  bool is_running() const { return is_running_; }
  bool was_idle() const { return breach_ && breach_->is_idleness; }  // and was ended for it
  // Whether the last work ended in a way that leaves in doubt what its process did before.
  bool was_fault() const { return is_fault_; }
  // Ends the child where it is over a limit, collects it where it has ended. True once the work
  // has ended.
  bool poll();
  void wait(int milliseconds) const;  // for its end, so long at most
  // Tells the child to save its state and end. Several children can be told before the first wait.
  void ask_to_stop();
  // Tells it, waits a little, ends it: what was not done by then is `interrupted`.
  void interrupt();
  void conclude(Status status,
                const std::string& message);  // of one that has ended: another result
  const Trace& trace() const { return shared_->trace; }
  const CapturedOutput& output() const { return output_; }
  // The point that the child returned, for verification by another process, which inherits the
  // memory if it starts after this worker was made.
  void keep_returned(std::span<const double> theta);  // by the child
  const double* returned() const { return shared_->returned.theta; }
  Index returned_size() const;  // 0: nothing
  // Readable when the work has ended.
  int descriptor() const { return channel_ >= 0 ? channel_ : group_.descriptor(); }

 private:
  struct Shared {
    Trace trace;
    alignas(4096) Returned returned;  // pages of its own, which take no memory until written
  };
  void reset(const Limits& limits, int threads, double processor_seconds_before);
  void settle_in(int threads) const;                  // in the child, as what follows
  void run(const std::function<void(Trace&)>& work);  // and notes how it ended
  [[noreturn]] void serve(const std::function<void(const Request&, Trace&)>& work, int channel);
  bool has_answered();
  void finish(int wait_status, std::int64_t peak_memory_bytes);

  Shared* const shared_;
  ProcessGroup group_;
  int channel_ = -1;  // to a child that is kept ready
  int threads_ = 1;
  double used_seconds_ = 0;  // of processor time by that child, at the end of its last work
  bool is_running_ = false, is_fault_ = false;
  CapturedOutput output_;
  LimitWatch watch_;
  std::optional<LimitWatch::Breach> breach_;  // why we killed it
  std::int64_t asked_to_stop_ = 0;            // monotonic nanoseconds; 0: it was not
};

// The result of work in another process, such as metadata, audits and checks that may crash: its
// text, or the reason why it is missing.
struct IsolatedText {
  std::optional<std::string> text;
  std::string failure;  // "it threw: …", "it was ended by signal 11 (Segmentation fault)", …
  bool is_interrupted = false;  // another program killed it, or the component's own program
};

// The limit of work that makes calls to another program, each of which may take hours, and during
// which it is not idle.
inline constexpr double kForeignSeconds = 86'400;
inline bool is_elsewhere(const Component& component) {
  return component.foreign && component.foreign->door == "process";
}

// Ends it after this many seconds of processor time, or five times as many of wall time, or if it
// and all that it started are idle for as long, at most a minute, or when this process is to end.
// Calls `waiting` fifty times a second.
IsolatedText isolated_text(const std::function<std::string()>& work, double seconds,
                           std::int64_t memory_bytes = Limits{}.memory_bytes,
                           const std::function<void()>& waiting = {});
// The same for work that leaves its progress in the trace, which `waiting` reads.
IsolatedText isolated_text(const std::function<std::string(Trace&)>& work, double seconds,
                           std::int64_t memory_bytes,
                           const std::function<void(const Trace&)>& waiting);

}  // namespace isoline::benchmarks
