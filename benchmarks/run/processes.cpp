// /proc, read by plain calls: a limit that is looked at fifty times a second must cost little.
#include "benchmarks/run/processes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// What is marked: how many files a process may lock. Linux has not looked at this limit since 2.4,
// and every process inherits it.
constexpr auto kMarked = static_cast<__rlimit_resource>(RLIMIT_LOCKS);
constexpr std::string_view kMarkedLine = "Max file locks";

// Empty where it cannot be read.
std::string text_of(const std::string& path) {
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
  const std::string text = text_of(fmt::format("/proc/{}/stat", process));
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
  const std::string text = text_of(fmt::format("/proc/{}/smaps_rollup", process));
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
    append_numbers(text_of(thread->path() / "children"), children);
  return children;
}

std::vector<pid_t> processes_of_this_namespace() {
  const auto namespace_of = [](const std::string& process) {
    std::error_code error;
    return fs::read_symlink("/proc/" + process + "/ns/pid", error);  // empty where it is not told
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
  const std::string text = text_of(fmt::format("/proc/{}/limits", process));
  const std::size_t line = text.find(kMarkedLine);
  if (line == std::string::npos) return 0;
  return std::strtoull(text.c_str() + line + kMarkedLine.size(), nullptr, 10);  // "unlimited": 0
}

}  // namespace isoline::benchmarks
