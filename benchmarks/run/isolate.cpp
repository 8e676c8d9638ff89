// Worker processes: fork, shared trace, limits, collection.
#include "benchmarks/run/isolate.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>

#include "core/clock.h"
#include "core/errors.h"
#include "core/threads.h"

namespace isoline::benchmarks {
namespace {

constexpr int kMemoryExit = 77;  // how a child says that an allocation failed outside of any catch
constexpr int kThrownExit = 78;  // that what it wrote is an exception's text

// Resident and virtual size of a process in bytes; 0 when it is gone.
struct Sizes {
  std::int64_t resident = 0, address_space = 0;
};
Sizes sizes_of(pid_t pid) {
  std::ifstream in(fmt::format("/proc/{}/statm", pid));
  std::int64_t pages = 0, resident = 0;
  in >> pages >> resident;
  const std::int64_t page = sysconf(_SC_PAGESIZE);
  return {resident * page, pages * page};
}

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

// The child dies with its parent, leaves Ctrl-C to it, dumps no core and holds its memory limit.
void confine(pid_t parent, [[maybe_unused]] std::int64_t memory_bytes) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_DFL);
  limit(RLIMIT_CORE, 0);
#ifndef ISOLINE_SANITIZE  // the sanitizers' shadow memory does not fit under an address-space limit
  limit(RLIMIT_AS, static_cast<rlim_t>(memory_bytes + sizes_of(getpid()).address_space));
#endif
  std::set_new_handler([] { throw std::bad_alloc(); });
}

}  // namespace

Worker::Worker() {
  void* shared =
      mmap(nullptr, sizeof(Trace), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::bad_alloc();
  trace_ = new (shared) Trace;
}

Worker::~Worker() {
  if (is_running()) interrupt();
  munmap(trace_, sizeof(Trace));
}

void Worker::start(const std::function<void(Trace&)>& work, const Limits& limits, int threads) {
  trace_ = new (trace_) Trace;
  limits_ = limits;
  verdict_.reset();
  started_ = monotonic_nanoseconds();
  std::fflush(nullptr);  // or the child would print what is still buffered again
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0)
    throw std::runtime_error(fmt::format("cannot start a process: {}", strerror(errno)));
  if (pid_ == 0) {
    confine(parent, limits.memory_bytes);
    set_library_threads(threads);
    try {
      work(*trace_);
    } catch (...) {
      _exit(kMemoryExit);
    }
    trace_->is_finished = true;
    _exit(0);
  }
  descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
}

void Worker::kill_as(Status status, const std::string& message) {
  verdict_ = status;
  set_text(trace_->message, message);
  kill(pid_, SIGKILL);
}

void Worker::enforce() {
  const double age = 1e-9 * static_cast<double>(monotonic_nanoseconds() - started_);
  const std::int64_t first = trace_->first_oracle_nanoseconds;
  if (first == 0) {
    if (age > limits_.startup_seconds)
      kill_as(Status::timeout, fmt::format("killed: no oracle call within {} s of its start",
                                           limits_.startup_seconds));
  } else if (1e-9 * static_cast<double>(monotonic_nanoseconds() - first) > limits_.hard_seconds) {
    kill_as(Status::timeout, fmt::format("killed at the hard limit of {} s", limits_.hard_seconds));
  } else if (sizes_of(pid_).resident > limits_.memory_bytes) {
    kill_as(Status::memory,
            fmt::format("killed: more than {} MiB resident", limits_.memory_bytes >> 20));
  }
}

bool Worker::poll() {
  if (!is_running()) return true;
  int wait_status = 0;
  rusage usage{};
  pid_t ended = wait4(pid_, &wait_status, WNOHANG, &usage);
  if (ended == 0 && !verdict_) enforce();
  if (ended == 0 && verdict_) ended = wait4(pid_, &wait_status, 0, &usage);
  if (ended == 0) return false;
  collect(wait_status, usage);
  return true;
}

void Worker::collect(int wait_status, const rusage& usage) {
  close(descriptor_);
  pid_ = 0;
  trace_->peak_memory_bytes = std::int64_t{usage.ru_maxrss} * 1024;
  if (verdict_) {
    trace_->status = *verdict_;
  } else if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    trace_->status = Status::crashed;
    set_text(trace_->message, fmt::format("ended by signal {} ({})", signal, strsignal(signal)));
  } else if (!trace_->is_finished) {
    const int code = WEXITSTATUS(wait_status);
    trace_->status = code == kMemoryExit ? Status::memory : Status::crashed;
    set_text(trace_->message, fmt::format("the process left with exit code {}", code));
  }
}

void Worker::interrupt() {
  verdict_ = Status::interrupted;
  constexpr int kGraceMilliseconds = 3000;  // for a child that keeps its state before it ends
  kill(pid_, SIGTERM);
  pollfd ending{descriptor_, POLLIN, 0};
  if (::poll(&ending, 1, kGraceMilliseconds) <= 0) kill(pid_, SIGKILL);
  int wait_status = 0;
  rusage usage{};
  while (wait4(pid_, &wait_status, 0, &usage) < 0 && errno == EINTR) {
  }
  set_text(trace_->message, "the run was interrupted");  // after the child kept its trace
  collect(wait_status, usage);
}

namespace {

// Everything that comes out of `descriptor` until `deadline`; nothing if it does not end by then.
std::optional<std::string> read_until(int descriptor, std::int64_t deadline) {
  std::string text;
  char buffer[1 << 16];
  for (;;) {
    const std::int64_t left = (deadline - monotonic_nanoseconds()) / 1'000'000;
    pollfd waiting{descriptor, POLLIN, 0};
    if (left <= 0 || ::poll(&waiting, 1, static_cast<int>(left)) == 0) return std::nullopt;
    const ssize_t got = read(descriptor, buffer, sizeof buffer);
    if (got < 0 && errno != EINTR) return std::nullopt;
    if (got == 0) return text;
    if (got > 0) text.append(buffer, static_cast<std::size_t>(got));
  }
}

void write_whole(const std::string& text, int descriptor) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t written = write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno != EINTR) _exit(1);
    if (written > 0) done += static_cast<std::size_t>(written);
  }
}

[[noreturn]] void write_and_exit(const std::function<std::string()>& work, int descriptor) {
  try {
    write_whole(work(), descriptor);
  } catch (const std::bad_alloc&) {
    _exit(kMemoryExit);
  } catch (const std::exception& error) {
    write_whole(error.what(), descriptor);
    _exit(kThrownExit);
  } catch (...) {
    write_whole("something that is no std::exception", descriptor);
    _exit(kThrownExit);
  }
  _exit(0);
}

IsolatedText judged(int wait_status, std::string text) {
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    return {{}, fmt::format("it was ended by signal {} ({})", signal, strsignal(signal))};
  }
  switch (const int code = WEXITSTATUS(wait_status)) {
    case 0:
      return {std::move(text), ""};
    case kThrownExit:
      return {{}, fmt::format("it threw: {}", text)};
    case kMemoryExit:
      return {{}, "it ran out of memory"};
    default:
      return {{}, fmt::format("it left with exit code {}", code)};
  }
}

}  // namespace

IsolatedText isolated_text(const std::function<std::string()>& work, double seconds,
                           std::int64_t memory_bytes) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return {{}, fmt::format("no pipe to it could be made: {}", strerror(errno))};
  std::fflush(nullptr);
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    confine(parent, memory_bytes);
    close(ends[0]);
    write_and_exit(work, ends[1]);
  }
  close(ends[1]);
  const auto deadline = monotonic_nanoseconds() + static_cast<std::int64_t>(1e9 * seconds);
  std::optional<std::string> text;
  if (child > 0) text = read_until(ends[0], deadline);
  close(ends[0]);
  if (child <= 0) return {{}, "its process could not be started"};
  if (!text) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!text) return {{}, fmt::format("it took more than {} s", seconds)};
  return judged(status, std::move(*text));
}

}  // namespace isoline::benchmarks
