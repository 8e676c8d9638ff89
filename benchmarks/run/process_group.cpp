// Groups of processes by fork, a process group, a pidfd and inherited marks. /proc is read by plain
// system calls, because limits are checked fifty times per second.
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
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "core/clock.h"
#include "core/status.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// Empty where it cannot be read.
std::string process_text(const std::string& path) {
  std::string text;
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return text;
  std::array<char, 4096> chunk;
  ssize_t got = 0;
  while ((got = read(file, chunk.data(), chunk.size())) > 0)
    text.append(chunk.data(), static_cast<std::size_t>(got));
  close(file);
  return text;
}

// The number behind a word of a file of a process; 0 without one, as behind "unlimited".
std::uint64_t number_behind(std::string_view word, pid_t process, const char* file) {
  const std::string text = process_text(fmt::format("/proc/{}/{}", process, file));
  const std::size_t at = text.find(word);
  return at == std::string::npos ? 0 : std::strtoull(text.c_str() + at + word.size(), nullptr, 10);
}

std::vector<pid_t> all_processes() {
  std::vector<pid_t> all;
  std::error_code error;
  for (fs::directory_iterator at("/proc", error), end; !error && at != end; at.increment(error))
    if (const long process = std::strtol(at->path().filename().c_str(), nullptr, 10); process > 0)
      all.push_back(static_cast<pid_t>(process));
  return all;
}

// The mark that a process sets and all its descendants inherit, in every session, group and
// program: its limit of file locks, which Linux has ignored since 2.4. It is a flag, the process
// that set it, and a number that no other of its groups has; 0: no mark.
constexpr auto kMarked = static_cast<__rlimit_resource>(RLIMIT_LOCKS);
constexpr std::uint64_t kOurs = 0x1501;
constexpr int kProcessBits = 22, kCountBits = 24;  // the kernel's most, and enough

std::uint64_t mark_of(pid_t process) { return number_behind("Max file locks", process, "limits"); }

std::uint64_t new_mark() {
  static std::uint64_t count = 0;
  const std::uint64_t number = ++count % (std::uint64_t{1} << kCountBits);
  return (kOurs << kProcessBits | static_cast<std::uint64_t>(getpid())) << kCountBits | number;
}

// The process that set it; 0 if it is not one of our marks.
pid_t giver_of(std::uint64_t mark) {
  const std::uint64_t head = mark >> kCountBits;
  const std::uint64_t process = head % (std::uint64_t{1} << kProcessBits);
  return head >> kProcessBits == kOurs ? static_cast<pid_t>(process) : 0;
}

// The children of this process that lead a group: a table that a handler of signals may read.
std::array<std::atomic<pid_t>, 4096> leaders{};

bool is_leader(pid_t process) {
  return std::ranges::any_of(leaders, [=](const auto& leader) { return leader == process; });
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// In the child: dies with its parent, leaves the keyboard to it, dumps no core.
void settle(pid_t parent, std::uint64_t mark) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  const rlimit marked{mark, mark}, none{0, 0};
  setrlimit(kMarked, &marked);  // refused only within a marked process: then that mark stays
  for (auto& leader : leaders) leader = 0;  // they are its parent's
  std::signal(SIGINT, SIG_IGN);
  for (const int signal : {SIGTERM, SIGHUP, SIGTSTP, SIGXFSZ}) std::signal(signal, SIG_DFL);
  setrlimit(RLIMIT_CORE, &none);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
}

// --- interrupts: handlers call only safe functions

constexpr std::array kHandled = {SIGINT, SIGTERM, SIGHUP, SIGTSTP};

volatile std::sig_atomic_t heard = 0;  // what is asked for
bool is_guarded = false;
std::array<struct sigaction, kHandled.size()> earlier_actions;

void signal_all_groups(int signal) {
  for (const auto& leader : leaders)
    if (const pid_t process = leader; process > 0) ::kill(-process, signal);
}

// Whether a program sent it that this process has started, in whatever group.
bool is_from_child(const siginfo_t& sent) {
  const pid_t group = sent.si_code <= 0 && sent.si_pid > 0 ? getpgid(sent.si_pid) : -1;
  siginfo_t state{};
  return group > 0 && (is_leader(group) || waitid(P_PID, static_cast<id_t>(group), &state,
                                                  WEXITED | WNOHANG | WNOWAIT) == 0);
}

void hear(int signal, siginfo_t* sent, void*) {
  if (signal == SIGTSTP) {
    signal_all_groups(SIGSTOP);
    raise(SIGSTOP);
    return signal_all_groups(SIGCONT);
  }
  if (is_from_child(*sent)) return;
  if (asked_to_end() == Asked::stop) {
    signal_all_groups(SIGKILL);
    _exit(kInterrupted);
  }
  const bool is_first_ctrl_c = signal == SIGINT && asked_to_end() == Asked::nothing;
  heard = static_cast<int>(is_first_ctrl_c ? Asked::finish : Asked::stop);
}

}  // namespace

std::optional<ProcessFigures> figures_of(pid_t process) {
  const std::string text = process_text(fmt::format("/proc/{}/stat", process));
  const std::size_t name_end = text.rfind(')');  // a name may hold anything
  if (name_end == std::string::npos) return std::nullopt;
  int parent = 0;
  unsigned long user = 0, system = 0;
  long children_user = 0, children_system = 0, resident_pages = 0;
  // The kernel's numbers fit. NOLINTNEXTLINE(bugprone-unchecked-string-to-number-conversion)
  const int read = std::sscanf(
      text.c_str() + name_end + 1,
      " %*c %d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu %ld %ld %*d %*d %*d %*d %*u %*u %ld",
      &parent, &user, &system, &children_user, &children_system, &resident_pages);
  if (read != 6) return std::nullopt;
  static const auto ticks_a_second = static_cast<double>(sysconf(_SC_CLK_TCK));
  static const std::int64_t page = sysconf(_SC_PAGESIZE);
  const double ticks = static_cast<double>(user) + static_cast<double>(system) +
                       static_cast<double>(children_user) + static_cast<double>(children_system);
  const std::string schedule = process_text(fmt::format("/proc/{}/schedstat", process));
  const std::size_t space = schedule.find(' ');  // a kernel may lack these statistics
  const double waiting =
      space == std::string::npos ? 0 : 1e-9 * std::strtod(schedule.c_str() + space, nullptr);
  return ProcessFigures{.parent = parent,
                        .processor_seconds = ticks / ticks_a_second,
                        .waiting_seconds = waiting,
                        .resident_bytes = resident_pages * page};
}

std::vector<pid_t> children_of(pid_t process) {
  static const bool has_lists =
      access(fmt::format("/proc/self/task/{}/children", getpid()).c_str(), R_OK) == 0;
  std::vector<pid_t> children;
  if (!has_lists) {  // in a kernel that was built without them every process says its parent
    for (const pid_t child : all_processes())
      if (const auto figures = figures_of(child); figures && figures->parent == process)
        children.push_back(child);
    return children;
  }
  std::error_code error;
  const fs::path threads = fmt::format("/proc/{}/task", process);
  for (fs::directory_iterator thread(threads, error), end; !error && thread != end;
       thread.increment(error)) {
    const std::string text = process_text(thread->path() / "children");
    char* at = nullptr;
    for (const char* from = text.c_str(); const long child = std::strtol(from, &at, 10); from = at)
      children.push_back(static_cast<pid_t>(child));
  }
  return children;
}

void limit_memory([[maybe_unused]] std::int64_t bytes) {
#ifndef ISOLINE_SANITIZE  // the sanitizers' shadow memory does not fit under an address-space limit
  const std::int64_t pages = std::strtoll(process_text("/proc/self/statm").c_str(), nullptr, 10);
  const auto most = static_cast<rlim_t>(bytes + pages * sysconf(_SC_PAGESIZE));
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min(most, limit.rlim_max);  // the other one stays: a child may lift this
  setrlimit(RLIMIT_AS, &limit);
#endif
  std::set_new_handler([] { throw std::bad_alloc(); });
}

std::string signal_name(int signal) {
  return fmt::format("signal {} ({})", signal, strsignal(signal));
}

std::string end_of_process(int wait_status) {
  if (WIFSIGNALED(wait_status)) return signal_name(WTERMSIG(wait_status)) + " ended it";
  const int code = WEXITSTATUS(wait_status);
  return code == 0 ? "it exited without an answer" : fmt::format("it exited with code {}", code);
}

void ProcessGroup::start(const std::function<void()>& work) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const auto* const free =
      std::ranges::find_if(leaders, [](const auto& leader) { return leader == 0; });
  if (free == leaders.end()) throw std::runtime_error("too many processes at a time");
  slot_ = static_cast<std::size_t>(free - leaders.begin());
  mark_ = new_mark();
  reaped_seconds_ = 0;
  peak_bytes_ = 0;
  std::fflush(nullptr);  // or the child would print what is still buffered again
  // Signals wait: one that the child sends at once must find it in the table.
  sigset_t all, before;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, &before);
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    settle(parent, mark_);
    sigprocmask(SIG_SETMASK, &before, nullptr);
    work();
    _exit(0);
  }
  const int error = errno;
  if (child > 0) {
    setpgid(child, child);  // here too: it may be signalled before it has come to its own call
    leaders[slot_] = leader_ = child;
    descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, child, 0));
  }
  sigprocmask(SIG_SETMASK, &before, nullptr);
  if (child < 0)
    throw std::runtime_error(fmt::format("cannot start a process: {}", strerror(error)));
}

ProcessGroup::End ProcessGroup::end() {
  kill();
  while (is_running()) {
    if (const auto end = collect()) return *end;
    siginfo_t ended{};
    waitid(P_PID, static_cast<id_t>(leader_), &ended, WEXITED | WNOWAIT);
  }
  return {};
}

// Descendants of ended parents are now children of this process. Those that have ended are reaped
// at once.
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

ProcessGroup::Usage ProcessGroup::usage(std::int64_t exact_above_bytes) {
  std::vector<pid_t> all = strays();
  if (is_running()) all.push_back(leader_);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const pid_t child : children_of(all[i]))
      if (std::ranges::find(all, child) == all.end()) all.push_back(child);
  Usage usage{.processes = all.size(), .processor_seconds = reaped_seconds_};
  for (const pid_t process : all) {
    const auto figures = figures_of(process);
    if (!figures) continue;
    usage.processor_seconds += figures->processor_seconds;
    usage.resident_bytes += figures->resident_bytes;
    usage.waiting_seconds += figures->waiting_seconds;
  }
  if (all.size() > 1 && usage.resident_bytes > exact_above_bytes) {  // what they share counts once
    std::int64_t exact = 0;
    for (const pid_t process : all)
      exact += 1024 * static_cast<std::int64_t>(number_behind("\nPss:", process, "smaps_rollup"));
    if (exact > 0) usage.resident_bytes = exact;
  }
  peak_bytes_ = std::max(peak_bytes_, usage.resident_bytes);
  return usage;
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
  for (const pid_t stray : strays()) ::kill(stray, SIGKILL);
}

std::optional<ProcessGroup::End> ProcessGroup::collect() {
  if (!is_running()) return std::nullopt;
  siginfo_t ended{};
  const int waited = waitid(P_PID, static_cast<id_t>(leader_), &ended, WEXITED | WNOHANG | WNOWAIT);
  if (waited == 0 && ended.si_pid == 0) return std::nullopt;
  ::kill(-leader_, SIGKILL);  // until the child is reaped, no other process can get its number
  End end;
  rusage used{};
  wait4(leader_, &end.wait_status, 0, &used);
  leaders[slot_] = leader_ = 0;
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
  reap_strays();
  end.peak_memory_bytes = std::max(std::int64_t{used.ru_maxrss} * 1024, peak_bytes_);
  return end;
}

// In rounds: the children of an ended process appear in the next round, until a round finds none. A
// process that the kernel cannot end, such as one that waits for a dead network disk, is left alone
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
  const auto namespace_of = [](const std::string& process) {  // empty if it cannot be read
    std::error_code error;
    return fs::read_symlink("/proc/" + process + "/ns/pid", error);
  };
  const fs::path own = namespace_of("self");  // in another one the givers have other numbers
  for (const pid_t process : all_processes()) {
    const pid_t giver = giver_of(mark_of(process));
    const bool is_orphan = giver > 0 && ::kill(giver, 0) != 0 && errno == ESRCH;
    if (is_orphan && !own.empty() && namespace_of(std::to_string(process)) == own)
      ::kill(process, SIGKILL);
  }
}

void ignore_signals_of_children() {
  struct sigaction action {};
  struct sigaction earlier {};
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  action.sa_sigaction = [](int signal, siginfo_t* sent, void*) {
    if (is_from_child(*sent)) return;
    std::signal(signal, SIG_DFL);
    raise(signal);
  };
  for (const int signal : {SIGTERM, SIGHUP})
    if (sigaction(signal, nullptr, &earlier) == 0 && earlier.sa_handler == SIG_DFL)
      sigaction(signal, &action, nullptr);
}

InterruptGuard::InterruptGuard() : is_outermost_(!std::exchange(is_guarded, true)) {
  if (!is_outermost_) return;
  heard = 0;
  for (std::size_t i = 0; i < kHandled.size(); ++i) {
    struct sigaction action {};
    action.sa_sigaction = hear;
    action.sa_flags = SA_SIGINFO | (kHandled[i] == SIGTSTP ? SA_RESTART : 0);
    sigaction(kHandled[i], nullptr, &earlier_actions[i]);
    // An ignored signal stays ignored: nohup and background shells set this.
    if (earlier_actions[i].sa_handler != SIG_IGN) sigaction(kHandled[i], &action, nullptr);
  }
}

InterruptGuard::~InterruptGuard() {
  if (!is_outermost_) return;
  for (std::size_t i = 0; i < kHandled.size(); ++i)
    sigaction(kHandled[i], &earlier_actions[i], nullptr);
  is_guarded = false;
  heard = 0;
}

Asked asked_to_end() { return static_cast<Asked>(heard); }

}  // namespace isoline::benchmarks
