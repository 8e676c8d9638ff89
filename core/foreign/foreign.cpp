// The identity of an external program within a build, and programs started by fork and exec, with
// what they print through a pipe.
#include "core/foreign/foreign.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"
#include "core/threads.h"

extern char** environ;

namespace isoline {

namespace fs = std::filesystem;

std::string digest_of_files(std::span<const std::string> words) {
  std::string all;
  for (const std::string& word : words) {
    std::error_code error;
    if (fs::is_regular_file(word, error)) all += digest(read_text(word)) + "\n";
  }
  return digest(all);
}

// Not of its label, note and source, which are words about it.
std::string digest_of(const Foreign& foreign) {
  std::string all = foreign.door + "\n" + foreign.command + "\n" + foreign.digest + "\n" +
                    foreign.interpreter + "\n";
  for (const auto& [name, version] : foreign.packages)
    all.append(name).append(" ").append(version).append("\n");
  return digest(all);
}

fs::path client_folder(const std::string& language) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const std::array<fs::path, 3> candidates = {
      program.parent_path().parent_path() / "share/isoline" / language,
      fs::path(ISOLINE_CLIENTS) / language, fs::path(ISOLINE_INSTALLED_CLIENTS) / language};
  for (const fs::path& folder : candidates)
    if (fs::is_directory(folder, error)) return folder;
  return candidates.back();
}

// Programs beside this one.

namespace {

constexpr std::size_t kTail = 4000;                        // bytes of the end that are remembered
constexpr std::size_t kMostPassed = std::size_t{1} << 20;  // bytes: more than a record keeps
constexpr std::size_t kLastLines = 8, kLastBytes = 600;
constexpr int kWidePipe =
    1 << 20;                    // bytes: a program that prints much does not wait for every read
constexpr int kMostReads = 64;  // per read, so that a program that prints forever does not block us
constexpr double kEndingSeconds = 0.5;  // between a closed socket and the exit behind it

bool& belongs_to_a_cell() {
  static bool belongs = false;
  return belongs;
}

bool is_set_by(const std::vector<std::pair<std::string, std::string>>& environment,
               std::string_view entry) {
  return std::ranges::any_of(environment, [&](const auto& own) {
    return entry.starts_with(own.first) && entry.substr(own.first.size()).starts_with('=');
  });
}

// As exec takes them: texts, and pointers to them that end with a null.
struct Texts {
  std::vector<std::string> texts;
  std::vector<char*> pointers = {};

  char** list() {
    pointers.clear();
    for (std::string& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers.data();
  }
};

Texts environment_of(std::vector<std::pair<std::string, std::string>> own) {
  const std::string threads = std::to_string(library_threads());
  for (const char* name : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"})
    own.emplace_back(name, threads);
  Texts all;
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (!is_set_by(own, *entry)) all.texts.emplace_back(*entry);
  for (const auto& [name, value] : own) all.texts.push_back(fmt::format("{}={}", name, value));
  return all;
}

// Between fork and exec, no function that takes a lock may be called.
struct Launch {
  char** words;
  char** environment;
  int output, failure, kept;
  bool leads_group;
  pid_t parent;

  [[noreturn]] void go() const {
    if (leads_group) setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    rlimit memory{};  // its group's resident memory is watched instead: it maps more than it uses
    if (getrlimit(RLIMIT_AS, &memory) == 0) {
      memory.rlim_cur = memory.rlim_max;
      setrlimit(RLIMIT_AS, &memory);
    }
    const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0) give_up();  // else it reads our own input
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    if (kept >= 0) fcntl(kept, F_SETFD, 0);
    execvpe(words[0], words, environment);
    give_up();
  }

  [[noreturn]] void give_up() const {
    const int why = errno;
    if (write(failure, &why, sizeof why) < 0) _exit(1);
    _exit(127);
  }
};

// The two ends of a pipe that closes with its scope.
struct Pipe {
  int read_end = -1, write_end = -1;

  Pipe() {
    int ends[2];
    require(pipe2(ends, O_CLOEXEC) == 0, "cannot create another pipe for a program");
    read_end = ends[0];
    write_end = ends[1];
  }
  ~Pipe() {
    for (const int end : {read_end, write_end})
      if (end >= 0) close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_write_end() { close(std::exchange(write_end, -1)); }
};

void write_all(int descriptor, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = write(descriptor, bytes, count);
    if (written <= 0) return;  // output without a reader is lost; the work continues
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

}  // namespace

void join_child_programs() { belongs_to_a_cell() = true; }

ChildProgram::ChildProgram(const Start& start)
    : command_(start.command), leads_group_(!belongs_to_a_cell()) {
  launch(start);
}

void ChildProgram::launch(const Start& start) {
  Texts words{shell_words(command_)}, environment = environment_of(start.environment);
  Pipe printed, failure;
  const Launch launch{words.list(),     environment.list(), printed.write_end, failure.write_end,
                      start.descriptor, leads_group_,       getpid()};
  const pid_t child = fork();
  require(child >= 0, [] { return fmt::format("cannot start a process: {}", strerror(errno)); });
  if (child == 0) launch.go();
  process_ = child;
  if (leads_group_) setpgid(child, child);  // here too: it may be killed before its own call
  failure.close_write_end();
  int why = 0;
  const bool has_failed = read(failure.read_end, &why, sizeof why) == sizeof why;
  if (has_failed) {
    waitpid(child, nullptr, 0);
    process_ = 0;
    throw UsageError(fmt::format("cannot start '{}': {}", words.texts[0], strerror(why)));
  }
  counted_.emplace(child);
  output_ = std::exchange(printed.read_end, -1);
  fcntl(output_, F_SETFL, O_NONBLOCK);
  fcntl(output_, F_SETPIPE_SZ, kWidePipe);
}

ChildProgram::~ChildProgram() {
  if (process_ > 0) {
    ::kill(leads_group_ ? -process_ : process_, SIGKILL);
    counted_.reset();
    waitpid(process_, nullptr, 0);
  }
  drain();
  if (output_ >= 0) close(output_);
}

void ChildProgram::drain() {
  std::array<char, 1 << 14> chunk;
  for (int i = 0; i < kMostReads && output_ >= 0; ++i) {
    const ssize_t got = read(output_, chunk.data(), chunk.size());
    if (got < 0) return;
    if (got == 0) {  // all writers have closed it
      close(std::exchange(output_, -1));
      return;
    }
    take(chunk.data(), static_cast<std::size_t>(got));
  }
}

void ChildProgram::take(const char* bytes, std::size_t count) {
  const std::size_t passed = belongs_to_a_cell() ? std::min(count, kMostPassed - passed_) : 0;
  write_all(STDERR_FILENO, bytes, passed);
  passed_ += passed;
  tail_.append(bytes, count);
  if (tail_.size() > kTail) tail_.erase(0, tail_.size() - kTail);
}

bool is_from_outside(int signal) {
  for (const int sent : {SIGKILL, SIGTERM, SIGINT, SIGQUIT, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2})
    if (signal == sent) return true;
  return false;
}

bool ChildProgram::has_ended() {
  drain();
  siginfo_t ended{};
  // It is reaped in the destructor only: until then, no other process can get its number or group.
  constexpr int kLook = WEXITED | WNOHANG | WNOWAIT;
  if (!end_ && waitid(P_PID, static_cast<id_t>(process_), &ended, kLook) == 0 && ended.si_pid != 0)
    end_ = End{ended.si_code == CLD_EXITED, ended.si_status};
  return end_.has_value();
}

void ChildProgram::await_end(double seconds) {
  constexpr int kMilliseconds = 2;
  for (int waited = 0; !has_ended() && waited < 1e3 * seconds; waited += kMilliseconds)
    poll(nullptr, 0, kMilliseconds);
  drain();
}

std::string ChildProgram::end_in_words() {
  await_end(kEndingSeconds);
  if (!end_) return "it is still running";
  if (end_->is_exit) return fmt::format("it exited with code {}", end_->number);
  return fmt::format("signal {} ({}) ended it", end_->number, strsignal(end_->number));
}

namespace {

// The exception below the last traceback, and the place that raised it; empty without a traceback.
std::string error_of_python(std::string_view words) {
  const std::string text =
      fmt::format("\n{}", words);  // that of a SyntaxError begins with its place
  const std::size_t place = text.rfind("\n  File \"");
  if (place == std::string::npos) return "";
  const std::size_t begin = place + 3;
  std::size_t line = text.find('\n', begin);
  const std::string file = text.substr(begin, line - begin);
  while (line != std::string::npos && text.compare(line, 3, "\n  ") == 0)
    line = text.find('\n', line + 1);  // its source
  if (line == std::string::npos) return "";
  return fmt::format("{} ({})", text.substr(line + 1, kLastBytes), file);
}

}  // namespace

std::string ChildProgram::last_words() const {
  std::string text = tail_;
  std::erase(text, '\0');  // a reader could take it for the end of the text
  std::string_view words = text;
  const std::size_t end = words.find_last_not_of("\n\r\t ");
  if (end == std::string_view::npos) return "";
  words = words.substr(0, end + 1);
  if (const std::string error = error_of_python(words); !error.empty()) return valid_utf8(error);
  std::size_t begin = words.size();
  for (std::size_t line = 0; line < kLastLines && begin != std::string_view::npos; ++line)
    begin = begin == 0 ? std::string_view::npos : words.rfind('\n', begin - 1);
  if (begin != std::string_view::npos) words.remove_prefix(begin + 1);
  if (words.size() > kLastBytes) words.remove_prefix(words.size() - kLastBytes);
  return valid_utf8(words);
}

}  // namespace isoline
