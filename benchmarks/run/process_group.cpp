// Groups of processes by fork, a process group, a pidfd and inherited marks.
#include "benchmarks/run/process_group.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "benchmarks/run/held_signals.h"
#include "benchmarks/run/processes.h"
#include "core/clock.h"

namespace isoline::benchmarks {
namespace {

// The children of this process that lead a group: a table that a handler of signals may read.
constexpr std::size_t kMostGroups = 4096;
std::array<std::atomic<pid_t>, kMostGroups> leaders{};

bool is_leader(pid_t process) {
  return std::ranges::any_of(leaders, [=](const auto& leader) { return leader == process; });
}

std::size_t free_slot() {
  const auto* const free =
      std::ranges::find_if(leaders, [](const auto& leader) { return leader == 0; });
  if (free == leaders.end()) throw std::runtime_error("too many processes at a time");
  return static_cast<std::size_t>(free - leaders.begin());
}

// A mark: that it is one of ours, who gave it, and a number that no other group of his has.
constexpr std::uint64_t kOurs = 0x1501;
constexpr int kProcessBits = 22, kCountBits = 24;  // the kernel's most, and enough

std::uint64_t new_mark() {
  static std::uint64_t count = 0;
  const std::uint64_t number = ++count % (std::uint64_t{1} << kCountBits);
  return (kOurs << kProcessBits | static_cast<std::uint64_t>(getpid())) << kCountBits | number;
}

// Who gave it; 0 where it is none of ours.
pid_t giver_of(std::uint64_t mark) {
  const std::uint64_t head = mark >> kCountBits;
  const std::uint64_t process = head % (std::uint64_t{1} << kProcessBits);
  return head >> kProcessBits == kOurs ? static_cast<pid_t>(process) : 0;
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// In the child: dies with its parent, leaves the keyboard to it, dumps no core.
void settle(pid_t parent, std::uint64_t mark) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  mark_this_process(mark);
  for (auto& leader : leaders) leader = 0;  // they are its parent's
  std::signal(SIGINT, SIG_IGN);
  for (const int signal : {SIGTERM, SIGHUP, SIGTSTP}) std::signal(signal, SIG_DFL);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
}

}  // namespace

ProcessGroup::~ProcessGroup() {
  if (is_running()) end();
}

ProcessGroup::End ProcessGroup::end() {
  kill();
  for (;;) {
    if (const auto end = collect()) return *end;
    siginfo_t ended{};
    waitid(P_PID, static_cast<id_t>(leader_), &ended, WEXITED | WNOWAIT);
  }
}

void ProcessGroup::start(const std::function<void()>& work) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  slot_ = free_slot();
  mark_ = new_mark();
  reaped_seconds_ = 0;
  peak_bytes_ = 0;
  std::fflush(nullptr);  // or the child would print what is still buffered again
  const HeldSignals held;
  const pid_t parent = getpid(), child = fork();
  if (child < 0)
    throw std::runtime_error(fmt::format("cannot start a process: {}", strerror(errno)));
  if (child == 0) {
    settle(parent, mark_);
    held.release();
    work();
    _exit(0);
  }
  setpgid(child, child);  // here too: it may be signalled before it has come to its own call
  leader_ = child;
  leaders[slot_] = child;
  descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, child, 0));
}

// Descendants whose parents have ended became children of this process. Those that have ended too
// are reaped at once.
std::vector<pid_t> ProcessGroup::strays() {
  std::vector<pid_t> children = children_of(getpid());
  std::erase_if(children, [&](pid_t child) {
    if (is_leader(child) || mark_of(child) != mark_) return true;
    rusage used{};
    if (wait4(child, nullptr, WNOHANG, &used) <= 0) return false;
    reaped_seconds_ += seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
    ++reaped_;
    return true;
  });
  return children;
}

std::vector<pid_t> ProcessGroup::members() {
  std::vector<pid_t> all = strays();
  if (is_running()) all.push_back(leader_);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const pid_t child : children_of(all[i]))
      if (std::ranges::find(all, child) == all.end()) all.push_back(child);
  return all;
}

ProcessGroup::Usage ProcessGroup::usage(std::int64_t exact_above_bytes) {
  const std::vector<pid_t> all = members();
  Usage usage{.processes = all.size(), .processor_seconds = reaped_seconds_};
  for (const pid_t process : all) {
    const auto figures = figures_of(process);
    if (!figures) continue;
    usage.processor_seconds += figures->processor_seconds;
    usage.resident_bytes += figures->resident_bytes;
  }
  if (all.size() > 1 && !control_) gather(all);
  if (all.size() > 1 && usage.resident_bytes > exact_above_bytes) {  // what they share counts once
    std::int64_t exact = 0;
    for (const pid_t process : all) exact += proportional_bytes(process);
    if (exact > 0) usage.resident_bytes = exact;
  }
  peak_bytes_ = std::max(peak_bytes_, usage.resident_bytes);
  return usage;
}

// A cell of one process, as nearly all are, is not worth the time that this takes.
void ProcessGroup::gather(const std::vector<pid_t>& members) {
  control_ = ControlGroup::make(mark_);
  if (!control_) return;
  for (const pid_t process : members) control_->take(process);
}

void ProcessGroup::ask_to_end() const {
  if (!is_running()) return;
  ::kill(leader_, SIGTERM);
  ::kill(leader_, SIGCONT);  // a stopped one would not hear
}

void ProcessGroup::kill() {
  if (!is_running()) return;  // 0 would mean the group that this process is in
  ::kill(-leader_, SIGKILL);
  ::kill(leader_, SIGKILL);  // it may have moved to another group
  if (control_) control_->kill();
  for (const pid_t stray : strays()) ::kill(stray, SIGKILL);
}

std::optional<ProcessGroup::End> ProcessGroup::collect() {
  if (!is_running()) return std::nullopt;
  siginfo_t ended{};
  const int waited = waitid(P_PID, static_cast<id_t>(leader_), &ended, WEXITED | WNOHANG | WNOWAIT);
  if (waited == 0 && ended.si_pid == 0) return std::nullopt;
  ::kill(-leader_, SIGKILL);  // until the child is reaped, its number is nobody else's
  End end;
  rusage used{};
  wait4(leader_, &end.wait_status, 0, &used);
  leave_table();
  if (control_) control_->kill();
  reap_strays();
  control_.reset();
  end.peak_memory_bytes = std::max(std::int64_t{used.ru_maxrss} * 1024, peak_bytes_);
  return end;
}

void ProcessGroup::leave_table() {
  leaders[slot_] = 0;
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
  leader_ = 0;
}

// Round by round: the children of one that has ended come up in the next, until one finds nobody. A
// process that the kernel cannot end, as one that waits for a dead network disk, is left to it
// after a while.
void ProcessGroup::reap_strays() {
  constexpr std::int64_t kMostNanoseconds = 5'000'000'000;
  constexpr useconds_t kMicroseconds = 200;
  const std::int64_t begin = monotonic_nanoseconds();
  while (monotonic_nanoseconds() - begin < kMostNanoseconds) {
    const std::int64_t reaped = reaped_;
    const std::vector<pid_t> left = strays();
    if (left.empty() && reaped == reaped_) return;
    for (const pid_t stray : left) ::kill(stray, SIGKILL);
    if (!left.empty()) usleep(kMicroseconds);
  }
}

void end_what_killed_runs_left() {
  for (const pid_t process : processes_of_this_namespace()) {
    const pid_t giver = giver_of(mark_of(process));
    const bool is_orphan = giver > 0 && ::kill(giver, 0) != 0 && errno == ESRCH;
    if (is_orphan) ::kill(process, SIGKILL);
  }
}

void signal_all_groups(int signal) noexcept {
  for (const auto& leader : leaders) {
    const pid_t process = leader;
    if (process > 0) ::kill(-process, signal);
  }
}

bool is_of_a_group(pid_t process) noexcept {
  const pid_t group = process > 0 ? getpgid(process) : -1;
  return group > 0 && is_leader(group);
}

}  // namespace isoline::benchmarks
