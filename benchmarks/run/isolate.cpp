// Child processes: the memory that they share with their parent, their output, their limits and
// their end.
#include "benchmarks/run/isolate.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "benchmarks/run/calls.h"
#include "benchmarks/run/keepers/keeper.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/foreign/foreign.h"
#include "core/foreign/line.h"
#include "core/text.h"
#include "core/threads.h"

namespace isoline::benchmarks {

std::vector<std::string> remarks_in(const std::string& output) {
  std::vector<std::string> remarks;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(kRemark)) remarks.push_back(line);
  return remarks;
}

namespace {

double seconds_between(std::int64_t begin, std::int64_t end) {
  return 1e-9 * static_cast<double>(end - begin);
}

// --- the output of a child process, through a pipe that its parent empties

void close_one(int& descriptor) {
  if (descriptor >= 0) ::close(std::exchange(descriptor, -1));
}

// --- workers

std::vector<void*>& all_shared_memory() {
  static std::vector<void*> all;
  return all;
}

void* mapped(std::size_t bytes) {
  void* const address = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                             MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (address == MAP_FAILED) throw std::bad_alloc();
  all_shared_memory().push_back(address);
  return address;
}

// Messages between a run and a child that is kept ready.
struct Task {
  const Request* request;  // in memory that both have since the fork
  std::int64_t memory_bytes;
};

struct Done {
  double processor_seconds;  // of the child so far
  std::int64_t peak_memory_bytes;
  bool leaves_processes;
};

double used_processor_seconds() {
  timespec used{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

// From now on getrusage() reports the largest memory since this call.
void forget_peak_memory() {
  static const int file = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
  [[maybe_unused]] const ssize_t written = pwrite(file, "5", 1, 0);  // proc(5)
}

std::int64_t peak_memory_bytes() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return std::int64_t{used.ru_maxrss} * 1024;
}

// Also children of children that have ended: they are this process's, which is their subreaper.
bool has_children() {
  siginfo_t any{};
  return waitid(P_ALL, 0, &any, WEXITED | WNOHANG | WNOWAIT) == 0;
}

// A file of memory, which is read once the child said that it is whole.
struct Answer {
  Answer() = default;
  ~Answer() { ::close(descriptor); }
  Answer(const Answer&) = delete;
  Answer& operator=(const Answer&) = delete;

  const int descriptor = memfd_create("answer", MFD_CLOEXEC);
  const std::string path = fmt::format("/proc/self/fd/{}", descriptor);
};

}  // namespace

Limits limits_of(const Request& request, const Limits& standard, double declared_seconds) {
  constexpr double kForeignStartup =
      600;  // the process adapter waits this long, and gives up first
  constexpr double kBudgetFactor = 2, kDeclaredFactor = 10;
  Limits limits = standard;
  if (request.problem.foreign || request.optimizer.foreign)
    limits.startup_seconds = std::max(limits.startup_seconds, kForeignStartup);
  const double budget = request.budget.seconds;
  if (std::isfinite(budget)) {
    limits.hard_seconds = kBudgetFactor * budget;
    limits.startup_seconds = std::max(limits.startup_seconds, limits.hard_seconds);
  } else if (request.hard_seconds > 0) {
    limits.hard_seconds = request.hard_seconds;
  } else if (std::isfinite(declared_seconds)) {
    limits.hard_seconds = std::max(standard.hard_seconds, kDeclaredFactor * declared_seconds);
  }
  if (request.problem.foreign && request.problem.foreign->door == "process")
    limits.hard_seconds *= request.problem.options.number("workers", 1);  // they share a group
  return limits;
}

double DeclaredTimes::of(const Request& request) {
  constexpr double kWorkPerIteration = 3, kSecondsPerFlop = 1e-9, kCallSeconds = 1e-7;
  const Component& problem = request.problem;
  const auto [at, is_new] = sheets_.try_emplace(problem.spec);
  Sheet& sheet = at->second;
  if (is_new) try {
      sheet = {.kind = "problem", .name = problem.name, .spec = problem.spec};
      const auto path = folder_ / "components" / sheet.file_name();
      sheet = sheet_from_text(read_text(path), path.string());
    } catch (const UsageError&) {  // missing or damaged: it says nothing
    }
  const double forward_seconds = sheet.prices ? sheet.prices->forward_seconds : 0;
  if (!(forward_seconds > 0)) return 0;
  const auto iterations = static_cast<double>(request.budget.iterations),
             n = static_cast<double>(sheet.unknowns);
  const double work =
      std::min(static_cast<double>(request.budget.work), kWorkPerIteration * iterations);
  double seconds = work * (forward_seconds + kCallSeconds);
  const OracleSet needs = catalog_.optimizers.at(request.optimizer.name).needs;
  if (needs.contains(Oracle::jacobian) || needs.contains(Oracle::hessian))
    seconds += std::min(iterations, work / std::max(1.0, n)) * kSecondsPerFlop * std::pow(n, 3);
  return std::min(seconds, request.budget.seconds);
}

std::optional<LimitWatch::Breach> LimitWatch::check(const ProcessGroup::Usage& usage,
                                                    bool has_asked_oracle,
                                                    std::int64_t now_nanoseconds) {
  constexpr double kLongestLook = 1;   // what is longer between two looks was no running
  constexpr double kIdleShare = 0.01;  // of a core
  awake_ += std::min(kLongestLook, seconds_between(last_nanoseconds_, now_nanoseconds));
  last_nanoseconds_ = now_nanoseconds;
  const Mark now{awake_, std::max(0.0, usage.processor_seconds - before_) / threads_,
                 usage.waiting_seconds};
  if (usage.resident_bytes > limits_.memory_bytes)
    return Breach{Status::memory,
                  fmt::format("killed: it used more than {} MiB; --memory sets another limit",
                              limits_.memory_bytes >> 20)};
  if (has_asked_oracle && !std::exchange(has_begun_, true)) begun_ = now;
  const double most = has_begun_ ? limits_.hard_seconds : limits_.startup_seconds;
  const char* const until = has_begun_ ? "" : " without an oracle call";
  if (now.processor - begun_.processor > most)
    return Breach{Status::timeout,
                  fmt::format("killed after {} s of processor time{}; --time sets another limit",
                              most, until)};
  if (now.awake - begun_.awake > Limits::kWallFactor * most)
    return Breach{
        Status::timeout,
        fmt::format("killed after {} s of wall time, {} times its limit of {} s of processor "
                    "time{}; --time sets another limit",
                    Limits::kWallFactor * most, Limits::kWallFactor, most, until)};
  active_.waiting = std::min(active_.waiting, now.waiting);  // without those that have ended
  const bool is_active =
      (limits_.waits_for_others && usage.processes > 1) ||
      (now.processor - active_.processor) * threads_ + now.waiting - active_.waiting >=
          kIdleShare * limits_.idle_seconds;
  if (is_active) active_ = now;
  if (now.awake - active_.awake <= limits_.idle_seconds) return std::nullopt;
  return Breach{
      Status::timeout,
      fmt::format("killed: it used less than 1 % of a core for {} s", limits_.idle_seconds), true};
}

void CapturedOutput::begin() {
  kept_.clear();
  tail_.clear();
  left_out_ = 0;
}

void CapturedOutput::open() {
  close();
  begin();
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
  constexpr std::size_t kTail = 200;  // bytes of the end that are remembered
  constexpr int kWidePipe = 1 << 20;  // bytes: a child that writes much does not wait for us
  constexpr int kMostReads = 64;      // so that one that writes forever does not hold us up
  std::array<char, 1 << 14> chunk;
  for (int i = 0; i < kMostReads && read_end_ >= 0; ++i) {
    const ssize_t got = read(read_end_, chunk.data(), chunk.size());
    if (got <= 0) return;
    if (!is_widened_) is_widened_ = fcntl(read_end_, F_SETPIPE_SZ, kWidePipe) >= 0;
    const auto count = static_cast<std::size_t>(got), kept = std::min(kMost - kept_.size(), count);
    kept_.append(chunk.data(), kept);
    left_out_ += count - kept;
    tail_.append(chunk.data(), count);
    if (tail_.size() > kTail) tail_.erase(0, tail_.size() - kTail);
  }
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
  const std::string_view words(tail_.data(), tail_.find_last_not_of("\n\r\t ") + 1);
  return valid_utf8(words.substr(words.find_last_of('\n') + 1));  // or from its beginning
}

Worker::Worker() : shared_(new (mapped(sizeof(Shared))) Shared) {}

Worker::~Worker() {
  if (is_running()) interrupt();
  retire();
  std::erase(all_shared_memory(), shared_);
  munmap(shared_, sizeof(Shared));
}

void Worker::keep_returned(std::span<const double> theta) {
  if (theta.size() > Returned::kMost) return;
  std::ranges::copy(theta, shared_->returned.theta);
  shared_->returned.size = static_cast<std::int64_t>(theta.size());
}

// Whatever the child wrote there is taken for a size only where it can be one.
Index Worker::returned_size() const {
  const std::int64_t size = shared_->returned.size;
  return size > 0 && size <= Returned::kMost ? size : 0;
}

void Worker::reset(const Limits& limits, int threads, double processor_seconds_before) {
  constexpr Index kLarge = 1 << 17;  // numbers: a MiB, which is given back
  if (returned_size() > kLarge) madvise(&shared_->returned, sizeof(Returned), MADV_REMOVE);
  new (&shared_->returned) Returned;
  new (&shared_->trace) Trace;
  breach_.reset();
  asked_to_stop_ = 0;
  is_fault_ = false;
  watch_ = LimitWatch(limits, threads, monotonic_nanoseconds(), processor_seconds_before);
}

void Worker::start(const std::function<void(Trace&)>& work, const Limits& limits, int threads) {
  retire();
  reset(limits, threads, 0);
  output_.open();
  group_.start([&] {
    settle_in(threads);
    limit_memory(limits.memory_bytes);
    run(work);
    _exit(0);
  });
  output_.close_child_end();
  is_running_ = true;
}

void Worker::keep_ready(const std::function<void(const Request&, Trace&)>& work, int threads) {
  retire();
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(
        fmt::format("cannot create a socket to a process: {}", std::strerror(errno)));
  channel_ = ends[0];
  threads_ = threads;
  used_seconds_ = 0;
  output_.open();
  try {
    group_.start([&] {
      ::close(ends[0]);
      settle_in(threads);
      serve(work, ends[1]);
    });
  } catch (...) {
    ::close(ends[1]);
    retire();
    throw;
  }
  ::close(ends[1]);
  output_.close_child_end();
}

void Worker::hand_over(const Request& request, const Limits& limits) {
  reset(limits, threads_, used_seconds_);
  output_.begin();
  const Task task{&request, limits.memory_bytes};
  ::send(channel_, &task, sizeof task, MSG_NOSIGNAL);  // that of a dead one is met when collected
  is_running_ = true;
}

void Worker::retire() {
  close_one(channel_);
  if (group_.is_running()) group_.end();
  output_.close();
}

void Worker::settle_in(int threads) const {
  output_.redirect();
  join_child_programs();
  for (void* const other : all_shared_memory())  // no cell can write into another's
    if (other != shared_) munmap(other, sizeof(Shared));
  set_library_threads(threads);
}

void Worker::run(const std::function<void(Trace&)>& work) {
  try {
    work(shared_->trace);
  } catch (const std::bad_alloc&) {
    conclude(Status::memory, "the cell exceeded its memory limit");
  } catch (const KilledProgram& error) {
    conclude(Status::interrupted, error.what());
  } catch (const std::exception& error) {
    conclude(Status::failed, error.what());
  } catch (...) {
    conclude(Status::failed, "an object that is not a std::exception");
  }
  shared_->trace.is_finished = true;
  std::fflush(stdout);
}

// A record's facts about its process count from the beginning of each work.
void Worker::serve(const std::function<void(const Request&, Trace&)>& work, int channel) {
  constexpr std::int64_t kLarge = 16 << 20;  // bytes of memory that are given back
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  Task task{};
  std::int64_t limit = 0, before = 0;  // bytes: the memory in use when the limit was set
  while (recv(channel, &task, sizeof task, 0) == sizeof task) {
    forget_peak_memory();
    if (std::exchange(limit, task.memory_bytes) != task.memory_bytes || before == 0) {
      limit_memory(task.memory_bytes);
      before = peak_memory_bytes();
    }
    run([&](Trace& trace) { work(*task.request, trace); });
    const Done done{used_processor_seconds(), peak_memory_bytes(), has_children()};
    if (done.peak_memory_bytes > before + kLarge) {
      malloc_trim(0);
      before = 0;
    }
    if (send(channel, &done, sizeof done, MSG_NOSIGNAL) != sizeof done) break;
  }
  _exit(0);
}

void Worker::conclude(Status status, const std::string& message) {
  shared_->trace.status = status;
  set_text(shared_->trace.message, message);
}

bool Worker::poll() {
  if (!is_running()) return true;
  if (channel_ >= 0 && has_answered()) return true;
  output_.drain();
  if (const auto end = group_.collect()) {
    output_.drain();
    retire();
    finish(end->wait_status, end->peak_memory_bytes);
    return true;
  }
  const std::int64_t now = monotonic_nanoseconds();
  if (breach_ || !watch_.is_due(now)) return false;
  const auto usage = group_.usage(watch_.limits().memory_bytes);
  breach_ = watch_.check(usage, trace().first_oracle_nanoseconds != 0, now);
  if (breach_) group_.kill();
  return false;
}

// The state of a child that is kept ready. It ends where its next work could be affected by this
// one.
bool Worker::has_answered() {
  Done done{};
  if (recv(channel_, &done, sizeof done, MSG_DONTWAIT) != sizeof done) return false;
  output_.drain();  // all was written before the answer
  used_seconds_ = done.processor_seconds;
  finish(0, done.peak_memory_bytes);
  if (is_fault_ || done.leaves_processes || trace().status == Status::interrupted) retire();
  return true;
}

void Worker::wait(int milliseconds) const {
  pollfd ending{descriptor(), POLLIN, 0};
  ::poll(&ending, 1, milliseconds);
}

void Worker::ask_to_stop() {
  if (!is_running() || asked_to_stop_ > 0) return;
  asked_to_stop_ = monotonic_nanoseconds();
  group_.ask_to_end();
}

void Worker::interrupt() {
  constexpr double kGraceSeconds = 3;  // to keep its state
  ask_to_stop();
  for (bool is_killed = false; !poll(); wait(kLookMilliseconds))
    if (!is_killed && seconds_between(asked_to_stop_, monotonic_nanoseconds()) > kGraceSeconds) {
      group_.kill();
      is_killed = true;
    }
}

// Everything that had the trace is dead by now, or waits for more work.
void Worker::finish(int wait_status, std::int64_t peak_memory_bytes) {
  is_running_ = false;
  Trace& trace = shared_->trace;
  const std::string defect = defect_of_all(trace);
  if (!defect.empty()) new (&trace) Trace;
  trace.peak_memory_bytes = peak_memory_bytes;
  const int signal = WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0;
  is_fault_ = true;
  if (breach_) {
    conclude(breach_->status, breach_->message);
  } else if (!defect.empty()) {
    conclude(Status::crashed, "it overwrote the trace of its run: " + defect);
  } else if (asked_to_stop_ > 0) {
    const bool has_verdict =
        trace.is_finished && trace.status != Status::running && trace.status != Status::interrupted;
    if (!has_verdict) conclude(Status::interrupted, "the run was interrupted");
    is_fault_ = false;
  } else if (is_from_outside(signal)) {
    conclude(Status::interrupted,
             fmt::format("killed by {}, sent by another program", signal_name(signal)));
    is_fault_ = false;
  } else if (signal != 0 || !trace.is_finished) {
    conclude(Status::crashed, end_of_process(wait_status));
  } else if (trace.status == Status::memory) {
    conclude(Status::memory,
             fmt::format("the cell exceeded its memory limit of {} MiB; --memory sets another one",
                         watch_.limits().memory_bytes >> 20));
  } else {
    is_fault_ = false;
  }
}

IsolatedText isolated_text(const std::function<std::string()>& work, double seconds,
                           std::int64_t memory_bytes, const std::function<void()>& waiting) {
  return isolated_text([&](Trace&) { return work(); }, seconds, memory_bytes,
                       [&](const Trace&) {
                         if (waiting) waiting();
                       });
}

IsolatedText isolated_text(const std::function<std::string(Trace&)>& work, double seconds,
                           std::int64_t memory_bytes,
                           const std::function<void(const Trace&)>& waiting) {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  constexpr double kIdleSeconds = 60, kForeignIdleSeconds = 600;
  const bool has_calls = seconds >= kForeignSeconds;
  const double idle_seconds = seconds > kForeignSeconds ? seconds
                              : has_calls               ? kForeignIdleSeconds
                                                        : std::min(seconds, kIdleSeconds);
  const Answer answer;
  Worker worker;
  try {
    if (answer.descriptor < 0) throw std::runtime_error(strerror(errno));
    worker.start(
        [&](Trace& trace) {
          const std::string text = work(trace);
          if (text.size() > kMost) throw std::runtime_error("its answer has more than 1 GiB");
          if (!(std::ofstream(answer.path, std::ios::binary) << text).flush())
            throw std::runtime_error(strerror(errno));
          trace.status = Status::converged;
        },
        {.startup_seconds = seconds,
         .hard_seconds = seconds,
         .idle_seconds = idle_seconds,
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
    waiting(worker.trace());
    worker.wait(kLookMilliseconds);
  }
  for (const std::string& remark : remarks_in(worker.output().text())) say(stderr, remark + "\n");
  switch (const Trace& trace = worker.trace(); trace.status) {
    case Status::converged:
      return {read_text(answer.path), ""};
    case Status::failed:
      return {{}, fmt::format("it threw: {}", valid_utf8(trace.message))};
    case Status::timeout:
      return {
          {},
          !worker.was_idle()
              ? fmt::format("it took more than {} s", seconds)
              : fmt::format(
                    "it was idle for more than {} s{}", idle_seconds,
                    has_calls ? "; the option call-time of process[…] sets another limit" : "")};
    case Status::memory:
      return {{}, "it ran out of memory"};
    default: {
      const std::string words = worker.output().last_words();
      return {{},
              trace.message + (words.empty() ? "" : "; it last wrote: " + words),
              trace.status == Status::interrupted};
    }
  }
}

}  // namespace isoline::benchmarks
