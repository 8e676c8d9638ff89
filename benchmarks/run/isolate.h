// One run in a process of its own: whatever it does to itself, this process goes on.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "benchmarks/run/captured_output.h"
#include "benchmarks/run/isolated_text.h"
#include "benchmarks/run/limits.h"
#include "benchmarks/run/process_group.h"
#include "benchmarks/run/returned.h"
#include "benchmarks/run/shared_memory.h"
#include "core/trace.h"

namespace isoline::benchmarks {

// Its trace lives in shared memory and outlives the child. Until the child has ended it may hold
// anything; then it is checked whole, and what is read of it is sound.
class Worker {
 public:
  Worker() = default;
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void start(const std::function<void(Trace&)>& work, const Limits& limits, int threads);
  bool is_running() const { return group_.is_running(); }
  // Ends the child where it is over a limit, collects it where it has ended. True once it has.
  bool poll();
  // Asks the child to keep its state and end. So that many may be asked before one is waited for.
  void ask_to_stop();
  void interrupt();  // asks, waits a little, ends it: what was not done by then is `interrupted`
  void dispute(const std::string& message);  // of a child that has ended: it failed after all
  const Trace& trace() const { return *trace_; }
  const CapturedOutput& output() const { return output_; }
  // What the child said that it returned, to be judged by another process, which inherits the
  // memory where it is started after this worker was made.
  void keep_returned(VectorRef theta) { returned_->keep(theta); }  // called by the child
  const double* returned() const { return returned_->theta; }
  Index returned_size() const;                            // 0: nothing
  int descriptor() const { return group_.descriptor(); }  // readable when the child has ended

 private:
  void do_in_child(const std::function<void(Trace&)>& work, int threads);
  void conclude(Status status, const std::string& message);
  void finish(const ProcessGroup::End& end);
  void judge_end(int wait_status);

  Shared<Trace> trace_;
  Shared<Returned> returned_;
  ProcessGroup group_;
  CapturedOutput output_;
  LimitWatch watch_;
  std::optional<LimitWatch::Breach> breach_;  // why we killed it
  std::int64_t asked_to_stop_ = 0;            // monotonic nanoseconds; 0: it was not
};

}  // namespace isoline::benchmarks
