// One run in a process of its own: whatever it does to itself, this process goes on.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <new>
#include <optional>
#include <span>
#include <string>

#include "benchmarks/run/limits.h"
#include "benchmarks/run/process_group.h"
#include "core/trace.h"

namespace isoline::benchmarks {

// Pages that are never written take no memory.
class SharedMemory {
 public:
  explicit SharedMemory(std::size_t bytes);
  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  void* address() const { return address_; }
  void release_pages();  // they are zero after that

  // In a child: gives back all but these.
  static void keep_only(std::initializer_list<const SharedMemory*> kept);

 private:
  void* address_;
  std::size_t bytes_;
};

// One object in memory of its own.
template <class T>
class Shared {
 public:
  Shared() : memory_(sizeof(T)) { renew(); }
  void renew() { object_ = new (memory_.address()) T; }
  T* operator->() const { return object_; }
  T& operator*() const { return *object_; }
  SharedMemory& memory() { return memory_; }

 private:
  SharedMemory memory_;
  T* object_;
};

// The θ that a cell returns, in memory shared with its verifier.
struct Returned {
  static constexpr std::int64_t kMost = std::int64_t{1} << 23;

  std::atomic<std::int64_t> size{0};  // 0: nothing was returned, or more than fits
  double theta[kMost];                // (n)

  void keep(std::span<const double> value) {
    if (value.size() > kMost) return;
    std::ranges::copy(value, theta);
    size = static_cast<std::int64_t>(value.size());
  }
};

// Captures the standard output and standard error of a child process, so that no terminal gets it,
// and keeps a bounded part.
class CapturedOutput {
 public:
  static constexpr std::size_t kMost = std::size_t{64} << 10;  // bytes kept, from the first on

  CapturedOutput() = default;
  ~CapturedOutput() { close(); }
  CapturedOutput(const CapturedOutput&) = delete;
  CapturedOutput& operator=(const CapturedOutput&) = delete;

  void open();             // before the child is forked
  void redirect() const;   // in the child
  void close_child_end();  // in the parent, once the child is forked
  void drain();            // takes what has come; what stays in the pipe holds the writer up
  void close();

  std::string text() const;        // valid UTF-8; says how much was left out
  std::string last_words() const;  // the last line that says something, cut to some 200 bytes

 private:
  void take(const char* bytes, std::size_t count);

  int read_end_ = -1, write_end_ = -1;
  bool is_widened_ = false;
  std::string kept_, tail_;
  std::int64_t left_out_ = 0;  // bytes
};

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
  bool was_idle() const { return breach_ && breach_->is_idleness; }  // and was ended for it
  // Ends the child where it is over a limit, collects it where it has ended. True once it has.
  bool poll();
  // Tells the child to save its state and end. Several children can be told before the first wait.
  void ask_to_stop();
  void
  interrupt();  // tells it, waits a little, ends it: what was not done by then is `interrupted`
  // For a child that has ended: replaces its result.
  void dispute(Status status, const std::string& message) { conclude(status, message); }
  const Trace& trace() const { return *trace_; }
  const CapturedOutput& output() const { return output_; }
  // The point that the child returned, for verification by another process, which inherits the
  // memory if it starts after this worker was made.
  void keep_returned(std::span<const double> theta) { returned_->keep(theta); }  // by the child
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

// The result of work in another process, such as metadata, audits and checks that may crash: its
// text, or the reason why it is missing.
struct IsolatedText {
  std::optional<std::string> text;
  std::string failure;  // "it threw: …", "it was ended by signal 11 (Segmentation fault)", …
};

// Ends it after this many seconds of processor time, or five times as many of wall time, or if it
// and all that it started are idle for as long, at most a minute. Calls `waiting` fifty times a
// second. Ends it, too, when this process is to end (interrupts.h).
IsolatedText isolated_text(const std::function<std::string()>& work, double seconds,
                           std::int64_t memory_bytes = Limits{}.memory_bytes,
                           const std::function<void()>& waiting = {});

}  // namespace isoline::benchmarks
