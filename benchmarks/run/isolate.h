// Work in a process of its own: whatever it does to itself, this process goes on.
#pragma once

#include <sys/resource.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/trace.h"

namespace isoline::benchmarks {

struct Limits {
  double startup_seconds = 30;  // from fork to the first oracle call
  double hard_seconds = 60;     // from the first oracle call
  std::int64_t memory_bytes = std::int64_t{4} << 30;
};

// One run in a child process. Its trace lives in shared memory and outlives the child.
class Worker {
 public:
  Worker();
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void start(const std::function<void(Trace&)>& work, const Limits& limits, int threads);
  bool is_running() const { return pid_ > 0; }
  // Ends the child where it is over a limit, collects it where it has ended. True once it has.
  bool poll();
  void interrupt();  // ends it at once, as `interrupted`
  const Trace& trace() const { return *trace_; }
  int descriptor() const { return descriptor_; }  // readable when the child has ended

 private:
  void kill_as(Status status, const std::string& message);
  void collect(int wait_status, const rusage& usage);
  void enforce();

  Trace* trace_;
  Limits limits_;
  pid_t pid_ = 0;
  int descriptor_ = -1;
  std::int64_t started_ = 0;       // monotonic nanoseconds
  std::optional<Status> verdict_;  // ours, when we killed it
};

// What work in a child process came to: its text, or why there is none.
struct IsolatedText {
  std::optional<std::string> text;
  std::string failure;  // "it threw: …", "it was ended by signal 11 (Segmentation fault)", …
};

IsolatedText isolated_text(const std::function<std::string()>& work, double seconds,
                           std::int64_t memory_bytes = Limits{}.memory_bytes);

}  // namespace isoline::benchmarks
