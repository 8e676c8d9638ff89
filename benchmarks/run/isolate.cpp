// Child processes: what they share with their parent, their output, their limits, their end.
#include "benchmarks/run/isolate.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "benchmarks/run/interrupts.h"
#include "benchmarks/run/process_group.h"
#include "core/clock.h"
#include "core/foreign/foreign.h"
#include "core/text.h"
#include "core/threads.h"

namespace isoline::benchmarks {
namespace {

std::vector<const SharedMemory*>& all_of_this_process() {
  static std::vector<const SharedMemory*> all;
  return all;
}

}  // namespace

SharedMemory::SharedMemory(std::size_t bytes)
    : address_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                    MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0)),
      bytes_(bytes) {
  if (address_ == MAP_FAILED) throw std::bad_alloc();
  all_of_this_process().push_back(this);
}

SharedMemory::~SharedMemory() {
  std::erase(all_of_this_process(), this);
  munmap(address_, bytes_);
}

void SharedMemory::release_pages() { madvise(address_, bytes_, MADV_REMOVE); }

void SharedMemory::keep_only(std::initializer_list<const SharedMemory*> kept) {
  for (const SharedMemory* memory : all_of_this_process())
    if (std::ranges::find(kept, memory) == kept.end()) munmap(memory->address_, memory->bytes_);
}

// The output of a child process, through a pipe that its parent empties.

namespace {

constexpr std::size_t kTail = 200;  // bytes of the end that are remembered
constexpr int kWidePipe = 1 << 20;  // bytes: a cell that writes much does not wait for every read
constexpr int kMostReads = 64;  // per read, so that a cell that writes forever does not block us

void close_one(int& descriptor) {
  if (descriptor >= 0) ::close(std::exchange(descriptor, -1));
}

}  // namespace

void CapturedOutput::open() {
  close();
  kept_.clear();
  tail_.clear();
  left_out_ = 0;
  is_widened_ = false;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;  // then the output is lost, and the work is not
  read_end_ = ends[0];
  write_end_ = ends[1];
  fcntl(read_end_, F_SETFL, O_NONBLOCK);
}

void CapturedOutput::redirect() const {
  const int out = write_end_ >= 0 ? write_end_ : ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  static char lines[BUFSIZ];  // written line by line, or a crash would take the last ones with it
  std::setvbuf(stdout, lines, _IOLBF, sizeof lines);
}

void CapturedOutput::close_child_end() { close_one(write_end_); }

void CapturedOutput::drain() {
  if (read_end_ < 0) return;
  std::array<char, 1 << 14> chunk;
  for (int i = 0; i < kMostReads; ++i) {
    const ssize_t got = read(read_end_, chunk.data(), chunk.size());
    if (got <= 0) return;
    if (!is_widened_) is_widened_ = fcntl(read_end_, F_SETPIPE_SZ, kWidePipe) >= 0;
    take(chunk.data(), static_cast<std::size_t>(got));
  }
}

void CapturedOutput::take(const char* bytes, std::size_t count) {
  const std::size_t room = kMost - kept_.size(), kept = std::min(room, count);
  kept_.append(bytes, kept);
  left_out_ += static_cast<std::int64_t>(count - kept);
  tail_.append(bytes, count);
  if (tail_.size() > kTail) tail_.erase(0, tail_.size() - kTail);
}

void CapturedOutput::close() {
  close_one(read_end_);
  close_one(write_end_);
}

std::string CapturedOutput::text() const {
  std::string text = valid_utf8(cut(kept_, left_out_ > 0 ? kMost - 1 : kMost));
  if (left_out_ > 0) text += fmt::format("\n… and {} bytes more\n", left_out_);
  return text;
}

std::string CapturedOutput::last_words() const {
  std::string_view words = tail_;
  const std::size_t end = words.find_last_not_of("\n\r\t ");
  if (end == std::string_view::npos) return "";
  words = words.substr(0, end + 1);
  const std::size_t line = words.find_last_of('\n');
  if (line != std::string_view::npos) words.remove_prefix(line + 1);
  return valid_utf8(words);
}

// Worker processes: a group, a shared trace, limits, and what an end means.

namespace {

struct Descriptor {
  explicit Descriptor(int opened) : number(opened) {}
  ~Descriptor() { ::close(number); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  const int number;
};

void write_whole(std::string_view bytes, int descriptor) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) throw std::runtime_error(strerror(errno));
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

std::string read_whole(int descriptor) {
  std::string bytes(static_cast<std::size_t>(std::max<off_t>(0, lseek(descriptor, 0, SEEK_END))),
                    '\0');
  const ssize_t got = pread(descriptor, bytes.data(), bytes.size(), 0);
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
  return bytes;
}

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
  } catch (...) {
    conclude(Status::failed, "an object that is not a std::exception");
  }
  trace_->is_finished = true;
  leave();
}

void Worker::conclude(Status status, const std::string& message) {
  trace_->status = status;
  set_text(trace_->message, message);
}

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
    return conclude(Status::crashed, "it overwrote the trace of its run: " + defect);
  if (asked_to_stop_ > 0) {
    if (!has_verdict(*trace_)) conclude(Status::interrupted, "the run was interrupted");
    return;
  }
  judge_end(end.wait_status);
  if (trace_->is_finished && trace_->status == Status::memory)
    conclude(Status::memory, fmt::format("out of its memory limit of {} MiB; --memory allows more",
                                         watch_.limits().memory_bytes >> 20));
}

void Worker::judge_end(int wait_status) {
  const int signal = WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0;
  if (is_from_outside(signal))
    return conclude(Status::interrupted,
                    fmt::format("killed by {}, sent by another program", signal_name(signal)));
  if (signal != 0 || !trace_->is_finished) conclude(Status::crashed, end_of_process(wait_status));
}

// Text from a child process: in a file of memory, which is read once the child said that it is
// whole.

IsolatedText isolated_text(const std::function<std::string()>& work, double seconds,
                           std::int64_t memory_bytes, const std::function<void()>& waiting) {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  constexpr double kIdleSeconds = 60;
  constexpr int kMilliseconds = 20;  // how often limits are looked at
  const Descriptor answer(memfd_create("answer", MFD_CLOEXEC));
  Worker worker;
  try {
    if (answer.number < 0) throw std::runtime_error(strerror(errno));
    worker.start(
        [&](Trace& trace) {
          const std::string text = work();
          if (text.size() > kMost) throw std::runtime_error("its answer has more than 1 GiB");
          write_whole(text, answer.number);
          trace.status = Status::converged;
        },
        {.startup_seconds = seconds,
         .hard_seconds = seconds,
         .idle_seconds = std::min(seconds, kIdleSeconds),
         .waits_for_others = false,
         .memory_bytes = memory_bytes},
        1);
  } catch (const std::runtime_error& error) {  // of the system, out of processes or of files
    return {{}, error.what()};
  }
  while (!worker.poll()) {
    if (asked_to_end() != Asked::nothing) {
      worker.interrupt();
      return {{}, "this program was stopped"};
    }
    if (waiting) waiting();
    pollfd ending{worker.descriptor(), POLLIN, 0};
    ::poll(&ending, 1, kMilliseconds);
  }
  switch (const Trace& trace = worker.trace(); trace.status) {
    case Status::converged:
      return {read_whole(answer.number), ""};
    case Status::failed:
      return {{}, fmt::format("it threw: {}", valid_utf8(trace.message))};
    case Status::timeout:
      return {{},
              worker.was_idle()
                  ? fmt::format("it was idle for more than {} s", std::min(seconds, kIdleSeconds))
                  : fmt::format("it took more than {} s", seconds)};
    case Status::memory:
      return {{}, "it ran out of memory"};
    default: {
      const std::string words = worker.output().last_words();
      return {{}, trace.message + (words.empty() ? "" : "; it last wrote: " + words)};
    }
  }
}

}  // namespace isoline::benchmarks
