// /proc, read by plain calls: a limit that is looked at fifty times a second must cost little.
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
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/clock.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// The limit that carries the mark: the number of file locks. Linux has ignored this limit
// since 2.4, and every process inherits it.
constexpr auto kMarked = static_cast<__rlimit_resource>(RLIMIT_LOCKS);
constexpr std::string_view kMarkedLine = "Max file locks";

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

void append_numbers(const std::string& text, std::vector<pid_t>& numbers) {
  const char* at = text.c_str();
  for (char* end = nullptr;; at = end) {
    const long number = std::strtol(at, &end, 10);
    if (end == at) return;
    numbers.push_back(static_cast<pid_t>(number));
  }
}

// 0 where a name of /proc is no process.
pid_t number_of(const std::string& name) {
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  return error == std::errc() && end == name.data() + name.size() ? process : 0;
}

std::vector<pid_t> all_processes() {
  std::vector<pid_t> all;
  std::error_code error;
  for (fs::directory_iterator at("/proc", error), end; !error && at != end; at.increment(error))
    if (const pid_t process = number_of(at->path().filename().string()); process > 0)
      all.push_back(process);
  return all;
}

// The kernel may have been built without lists of children: then every process says its parent.
std::vector<pid_t> children_by_their_parent(pid_t process) {
  std::vector<pid_t> children = all_processes();
  std::erase_if(children, [=](pid_t child) {
    const auto figures = figures_of(child);
    return !figures || figures->parent != process;
  });
  return children;
}

bool has_lists_of_children() {
  static const bool has =
      access(fmt::format("/proc/self/task/{}/children", getpid()).c_str(), R_OK) == 0;
  return has;
}

}  // namespace

std::optional<ProcessFigures> figures_of(pid_t process) {
  const std::string text = process_text(fmt::format("/proc/{}/stat", process));
  const std::size_t name_end = text.rfind(')');  // a name may hold anything
  if (name_end == std::string::npos) return std::nullopt;
  int parent = 0;
  unsigned long user = 0, system = 0, address_space = 0;
  long children_user = 0, children_system = 0, resident_pages = 0;
  // The kernel's numbers fit. NOLINTNEXTLINE(bugprone-unchecked-string-to-number-conversion)
  const int read = std::sscanf(
      text.c_str() + name_end + 1,
      " %*c %d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu %ld %ld %*d %*d %*d %*d %*u %lu %ld",
      &parent, &user, &system, &children_user, &children_system, &address_space, &resident_pages);
  if (read != 7) return std::nullopt;
  static const auto ticks_a_second = static_cast<double>(sysconf(_SC_CLK_TCK));
  static const std::int64_t page = sysconf(_SC_PAGESIZE);
  const double ticks = static_cast<double>(user) + static_cast<double>(system) +
                       static_cast<double>(children_user) + static_cast<double>(children_system);
  return ProcessFigures{.parent = parent,
                        .processor_seconds = ticks / ticks_a_second,
                        .resident_bytes = resident_pages * page,
                        .address_space_bytes = static_cast<std::int64_t>(address_space)};
}

std::int64_t proportional_bytes(pid_t process) {
  const std::string text = process_text(fmt::format("/proc/{}/smaps_rollup", process));
  constexpr std::string_view kLine = "\nPss:";
  const std::size_t line = text.find(kLine);
  if (line == std::string::npos) return 0;
  return std::strtoll(text.c_str() + line + kLine.size(), nullptr, 10) * 1024;
}

std::vector<pid_t> children_of(pid_t process) {
  if (!has_lists_of_children()) return children_by_their_parent(process);
  std::vector<pid_t> children;
  std::error_code error;
  const fs::path threads = fmt::format("/proc/{}/task", process);
  for (fs::directory_iterator thread(threads, error), end; !error && thread != end;
       thread.increment(error))
    append_numbers(process_text(thread->path() / "children"), children);
  return children;
}

std::vector<pid_t> processes_of_this_namespace() {
  const auto namespace_of = [](const std::string& process) {
    std::error_code error;
    return fs::read_symlink("/proc/" + process + "/ns/pid",
                            error);  // empty if the system does not report it
  };
  const fs::path own = namespace_of("self");
  std::vector<pid_t> all = all_processes();
  std::erase_if(all, [&](pid_t process) {
    return own.empty() || namespace_of(std::to_string(process)) != own;
  });
  return all;
}

void mark_this_process(std::uint64_t mark) {
  const rlimit both{mark, mark};
  setrlimit(kMarked, &both);  // refused only within a marked process: then that mark stays
}

std::uint64_t mark_of(pid_t process) {
  const std::string text = process_text(fmt::format("/proc/{}/limits", process));
  const std::size_t line = text.find(kMarkedLine);
  if (line == std::string::npos) return 0;
  return std::strtoull(text.c_str() + line + kMarkedLine.size(), nullptr, 10);  // "unlimited": 0
}

// Limits and leave of child processes.

void limit_memory([[maybe_unused]] std::int64_t bytes) {
#ifndef ISOLINE_SANITIZE  // the sanitizers' shadow memory does not fit under an address-space limit
  const auto figures = figures_of(getpid());
  const auto most = static_cast<rlim_t>(bytes + (figures ? figures->address_space_bytes : 0));
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min(most, limit.rlim_max);  // the other one stays: a child may lift this
  setrlimit(RLIMIT_AS, &limit);
#endif
  std::set_new_handler([] { throw std::bad_alloc(); });
}

void leave() {
  std::fflush(stdout);
  _exit(0);
}

std::string signal_name(int signal) {
  return fmt::format("signal {} ({})", signal, strsignal(signal));
}

std::string end_of_process(int wait_status) {
  if (WIFSIGNALED(wait_status)) return signal_name(WTERMSIG(wait_status)) + " ended it";
  const int code = WEXITSTATUS(wait_status);
  return code == 0 ? "it exited without an answer" : fmt::format("it exited with code {}", code);
}

// Groups of processes by fork, a process group, a pidfd and inherited marks.

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

// A mark: a flag, the process that set it, and a number that none of its other groups has.
constexpr std::uint64_t kOurs = 0x1501;
constexpr int kProcessBits = 22, kCountBits = 24;  // the kernel's most, and enough

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
  for (const int signal : {SIGTERM, SIGHUP, SIGTSTP, SIGXFSZ}) std::signal(signal, SIG_DFL);
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
  while (is_running()) {
    if (const auto end = collect()) return *end;
    siginfo_t ended{};
    waitid(P_PID, static_cast<id_t>(leader_), &ended, WEXITED | WNOWAIT);
  }
  return {};
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
  if (all.size() > 1 && usage.resident_bytes > exact_above_bytes) {  // what they share counts once
    std::int64_t exact = 0;
    for (const pid_t process : all) exact += proportional_bytes(process);
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
  leave_table();
  reap_strays();
  end.peak_memory_bytes = std::max(std::int64_t{used.ru_maxrss} * 1024, peak_bytes_);
  return end;
}

void ProcessGroup::leave_table() {
  leaders[slot_] = 0;
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
  leader_ = 0;
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
