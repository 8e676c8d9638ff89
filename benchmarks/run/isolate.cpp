// Worker processes: a group, a shared trace, limits, and what an end means.
#include "benchmarks/run/isolate.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>

#include <csignal>
#include <exception>
#include <new>

#include "benchmarks/run/child_process.h"
#include "core/clock.h"
#include "core/foreign/child.h"
#include "core/threads.h"

namespace isoline::benchmarks {
namespace {

// Whatever the child wrote there is taken for a size only where it can be one.
std::int64_t size_of(const Returned& returned) {
  const std::int64_t size = returned.size;
  return size > 0 && size <= Returned::kMost ? size : 0;
}

bool has_verdict(const Trace& trace) {
  return trace.is_finished && trace.status != Status::running &&
         trace.status != Status::interrupted;
}

}  // namespace

Worker::~Worker() {
  if (is_running()) interrupt();
}

Index Worker::returned_size() const { return size_of(*returned_); }

void Worker::start(const std::function<void(Trace&)>& work, const Limits& limits, int threads) {
  constexpr std::int64_t kLarge = 1 << 17;  // numbers: a MiB, which is given back
  if (size_of(*returned_) > kLarge) returned_.memory().release_pages();
  returned_.renew();
  trace_.renew();
  breach_.reset();
  asked_to_stop_ = 0;
  watch_ = LimitWatch(limits, threads, monotonic_nanoseconds());
  output_.open();
  group_.start([&] { do_in_child(work, threads); });
  output_.close_child_end();
}

void Worker::do_in_child(const std::function<void(Trace&)>& work, int threads) {
  output_.redirect();
  join_child_programs();
  SharedMemory::keep_only({&trace_.memory(), &returned_.memory()});
  limit_memory(watch_.limits().memory_bytes);
  set_library_threads(threads);
  try {
    work(*trace_);
  } catch (const std::bad_alloc&) {
    conclude(Status::memory, "out of its memory limit");
  } catch (const std::exception& error) {
    conclude(Status::failed, error.what());
  }
  trace_->is_finished = true;
  leave();
}

void Worker::conclude(Status status, const std::string& message) {
  trace_->status = status;
  set_text(trace_->message, message);
}

void Worker::dispute(const std::string& message) { conclude(Status::failed, message); }

bool Worker::poll() {
  if (!is_running()) return true;
  output_.drain();
  if (const auto end = group_.collect()) {
    finish(*end);
    return true;
  }
  const std::int64_t now = monotonic_nanoseconds();
  if (breach_ || !watch_.is_due(now)) return false;
  const auto usage = group_.usage(watch_.limits().memory_bytes);
  breach_ = watch_.check(usage, trace_->first_oracle_nanoseconds != 0, now);
  if (breach_) group_.kill();
  return false;
}

void Worker::ask_to_stop() {
  if (!is_running() || asked_to_stop_ > 0) return;
  asked_to_stop_ = monotonic_nanoseconds();
  group_.ask_to_end();
}

void Worker::interrupt() {
  constexpr std::int64_t kGraceNanoseconds = 3'000'000'000;  // to keep its state
  constexpr int kMilliseconds = 20;                          // between two looks at its output
  ask_to_stop();
  for (bool is_killed = false; !poll();) {
    if (!is_killed && monotonic_nanoseconds() - asked_to_stop_ > kGraceNanoseconds) {
      group_.kill();
      is_killed = true;
    }
    pollfd ending{descriptor(), POLLIN, 0};
    ::poll(&ending, 1, kMilliseconds);
  }
}

// Everything that had the trace is dead by now.
void Worker::finish(const ProcessGroup::End& end) {
  output_.drain();
  output_.close();
  const std::string defect = defect_of(*trace_);
  if (!defect.empty()) trace_.renew();
  trace_->peak_memory_bytes = end.peak_memory_bytes;
  if (breach_) return conclude(breach_->status, breach_->message);
  if (!defect.empty())
    return conclude(Status::crashed, "it wrote over the trace of its run: " + defect);
  if (asked_to_stop_ > 0) {
    if (!has_verdict(*trace_)) conclude(Status::interrupted, "the run was interrupted");
    return;
  }
  judge_end(end.wait_status);
}

void Worker::judge_end(int wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    const std::string name = signal_name(signal);
    if (is_from_outside(signal))
      return conclude(Status::interrupted,
                      fmt::format("killed by {}, which this program did not send", name));
    return conclude(Status::crashed, "ended by " + name);
  }
  if (!trace_->is_finished)
    return conclude(Status::crashed,
                    fmt::format("the process left with exit code {}", WEXITSTATUS(wait_status)));
}

}  // namespace isoline::benchmarks
