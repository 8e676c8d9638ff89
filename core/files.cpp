// Files by system calls, with every result checked.
#include "core/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

#include "core/errors.h"
#include "core/output.h"
#include "core/text.h"

namespace isoline {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const char* what, const fs::path& path) {
  throw std::runtime_error(fmt::format("cannot {} {}: {}", what, path.string(), strerror(errno)));
}

// An open file, closed with its scope; `close` returns whether that succeeded.
class OpenFile {
 public:
  OpenFile(const fs::path& path, int how)
      : descriptor_(::open(path.c_str(), how | O_CLOEXEC, 0644)) {}
  OpenFile(const fs::path& path, int how, const char* what) : OpenFile(path, how) {
    if (descriptor_ < 0) fail(what, path);
  }
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor() const { return descriptor_; }
  bool close() { return ::close(std::exchange(descriptor_, -1)) == 0; }

 private:
  int descriptor_;
};

void write_all(int file, std::string_view text, const fs::path& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", path);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

// Errors name `shown`, the file that the user knows.
void write_new(const fs::path& path, std::string_view text, bool is_flushed,
               const fs::path& shown) {
  OpenFile file(path, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW);
  if (file.descriptor() < 0) fail("create", shown);
  write_all(file.descriptor(), text, shown);
  if (is_flushed && ::fsync(file.descriptor()) != 0) fail("flush", shown);
  if (!file.close()) fail("close", shown);
}

[[noreturn]] void refuse(const fs::path& path, std::string_view reason) {
  throw UsageError(fmt::format("cannot read {}: {}", path.string(), reason));
}

[[noreturn]] void refuse_as_the_system(const fs::path& path) {
  if (errno == ENOENT) throw UsageError(path.string() + ": no such file");
  if (errno == ELOOP) refuse(path, strerror(errno));
  throw AccessError(fmt::format("cannot read {}: {}", path.string(), strerror(errno)));
}

// The kind of a path that is not a regular file.
const char* oddity_of(mode_t mode) {
  if (S_ISREG(mode)) return nullptr;
  if (S_ISDIR(mode)) return "it is a folder";
  if (S_ISFIFO(mode)) return "it is a pipe";
  if (S_ISSOCK(mode)) return "it is a socket";
  if (S_ISLNK(mode)) return "it is a symbolic link, which is not followed here";
  return "it is a device";
}

void require_readable(const struct stat& found, const fs::path& path, std::size_t most_bytes) {
  if (const char* oddity = oddity_of(found.st_mode)) refuse(path, oddity);
  if (static_cast<std::size_t>(found.st_size) > most_bytes)
    refuse(path,
           fmt::format("it has {} bytes, and at most {} are read", found.st_size, most_bytes));
}

// Reads an open file whole. The expected size is a hint: for some system files it is 0.
std::string all_of(int file, std::size_t size, const fs::path& path, std::size_t most_bytes) {
  constexpr std::size_t kLeast = 1 << 12;
  std::string text(std::max(size + 1, kLeast), '\0');  // one byte more, to detect the end
  std::size_t have = 0;
  for (;;) {
    const ssize_t got = ::read(file, text.data() + have, text.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(path, strerror(errno));
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
    if (have > most_bytes) refuse(path, fmt::format("it grows beyond {} bytes", most_bytes));
    if (have == text.size()) text.resize(2 * have);
  }
  text.resize(have);
  return text;
}

// "9c1d52aa": distinguishes this machine's processes from those of others. Machines made of one
// image differ in their host's name, and containers have process numbers of their own.
std::string machine_name() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  std::string identity;
  std::getline(std::ifstream("/etc/machine-id"), identity);
  std::error_code unknown;
  const fs::path numbers = fs::read_symlink("/proc/self/ns/pid", unknown);
  constexpr std::size_t kDigits = 8;
  return digest(fmt::format("{} {} {}", identity, host.data(), numbers.string()))
      .substr(0, kDigits);
}

const std::string& this_machine() {
  static const std::string name = machine_name();
  return name;
}

// The process of this machine that a temporary file is named after.
std::optional<pid_t> writer_of(const fs::path& path) {
  if (path.extension() != ".tmp") return std::nullopt;
  const std::string writer = path.stem().extension().string();  // ".9c1d52aa-4711"
  const std::string ours = "." + this_machine() + "-";
  if (!writer.starts_with(ours)) return std::nullopt;
  pid_t process = 0;
  const char* const end = writer.data() + writer.size();
  const auto [stop, error] = std::from_chars(writer.data() + ours.size(), end, process);
  if (error != std::errc() || stop != end || process <= 0) return std::nullopt;
  return process;
}

// Does not replace an existing file. If the file system cannot guarantee this, the function checks
// for the file first.
bool has_moved(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
  if (!is_there(to)) return ::rename(from.c_str(), to.c_str()) == 0;
  errno = EEXIST;
  return false;
}

bool is_of_a_dead_process(const fs::path& path) {
  const std::optional<pid_t> writer = writer_of(path);
  return writer && ::kill(*writer, 0) != 0 && errno == ESRCH;
}

}  // namespace

// The file is checked before it is opened, because opening some devices has an effect, and again
// after it is open, because another file may have replaced it.
std::string read_text(const fs::path& path, std::size_t most_bytes, Links links) {
  const bool follows = links == Links::followed;
  struct stat found {};
  if ((follows ? ::stat : ::lstat)(path.c_str(), &found) != 0) refuse_as_the_system(path);
  require_readable(found, path, most_bytes);
  const OpenFile file(path, O_RDONLY | O_NONBLOCK | (follows ? 0 : O_NOFOLLOW));
  if (file.descriptor() < 0 || ::fstat(file.descriptor(), &found) != 0) refuse_as_the_system(path);
  require_readable(found, path, most_bytes);
  return all_of(file.descriptor(), static_cast<std::size_t>(found.st_size), path, most_bytes);
}

bool is_there(const fs::path& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0;
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  fs::directory_iterator at(folder, error);
  if (error == std::errc::no_such_file_or_directory) return names;
  for (; !error && at != fs::directory_iterator(); at.increment(error))
    names.push_back(at->path().filename().string());
  require(!error,
          [&] { return fmt::format("cannot list {}: {}", folder.string(), error.message()); });
  std::ranges::sort(names);
  return names;
}

fs::path temporary_of(const fs::path& path) {
  return path.string() + fmt::format(".{}-{}.tmp", this_machine(), ::getpid());
}

bool is_abandoned(const fs::path& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0 && S_ISREG(found.st_mode) && is_of_a_dead_process(path);
}

fs::path move_into(const fs::path& folder, const fs::path& path) {
  std::error_code error;
  fs::create_directories(folder, error);
  constexpr int kMost = 1000;  // copies of one name
  for (int i = 1; i <= kMost; ++i) {
    const std::string number = i == 1 ? "" : fmt::format(".{}", i);
    fs::path place = folder / (path.filename().string() + number);
    if (has_moved(path, place)) return place;
    if (errno != EEXIST) break;
  }
  throw UsageError(
      fmt::format("cannot move {} into {}: {}", path.string(), folder.string(), strerror(errno)));
}

void write_text(const fs::path& path, std::string_view text) {
  const fs::path temporary = temporary_of(path);
  try {
    write_new(temporary, text, true, path);
    if (::rename(temporary.c_str(), path.c_str()) != 0) fail("rename to", path);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
}

void make_output_folder(const fs::path& folder) {
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  const auto refuse_it = [&](const std::string& reason) {
    throw UsageError(fmt::format("cannot write to the folder {}: {}; name another one with --out",
                                 folder.string(), reason));
  };
  for (fs::path part = folder; !part.empty(); part = part.parent_path()) {
    std::error_code unknown;
    if (fs::exists(part, unknown) && !fs::is_directory(part, unknown))
      refuse_it(part == folder ? "it is a file" : part.string() + " is a file");
    if (part == part.parent_path()) break;
  }
  if (error) refuse_it(error.message());
  if (::access(folder.empty() ? "." : folder.c_str(), W_OK) != 0) refuse_it(strerror(errno));
}

void require_ours(const fs::path& path, std::string_view mark) {
  std::error_code unknown;
  require(!fs::is_directory(path, unknown),
          [&] { return fmt::format("cannot write {}: it is a folder", path.string()); });
  if (!fs::is_regular_file(path, unknown) || fs::file_size(path, unknown) == 0) return;
  require(read_text(path).find(mark) != std::string::npos, [&] {
    return fmt::format("{} exists and does not contain {}: name another file, or remove it",
                       path.string(), mark);
  });
}

void write_output(const fs::path& path, std::string_view text, std::string_view mark) {
  require_ours(path, mark);
  std::error_code unknown;
  if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown)) {
    OpenFile file(path, O_WRONLY, "open");
    write_all(file.descriptor(), text, path);
    if (!file.close()) fail("close", path);
    return;
  }
  const fs::path place = fs::is_symlink(path, unknown) ? fs::weakly_canonical(path) : path;
  const fs::path folder = place.has_parent_path() ? place.parent_path() : ".";
  make_output_folder(folder);
  for (const std::string& name : names_in(folder))  // what a killed process left of this file
    if (name.starts_with(place.filename().string() + ".") && is_abandoned(folder / name))
      fs::remove(folder / name, unknown);
  write_text(place, text);
}

void write_unflushed(const fs::path& path, std::string_view text) {
  write_new(path, text, false, path);
}

void flush_all(const fs::path& folder) {
  const OpenFile file(folder, O_RDONLY | O_DIRECTORY, "open");
  if (::syncfs(file.descriptor()) != 0) fail("flush", folder);
}

std::string digest(std::string_view text) { return fmt::format("{:016x}", fnv1a(text)); }

HiddenFolder::HiddenFolder() {
  std::error_code error;
  const std::filesystem::path among = std::filesystem::temp_directory_path(error);
  require(!error, [&] {
    const char* named = std::getenv("TMPDIR");
    return fmt::format("TMPDIR must name a folder for temporary files, got {}",
                       printable(named != nullptr ? named : "none"));
  });
  // The name contains the ID of this process, so that the next run finds the files of a process
  // that was killed.
  std::error_code unreadable;
  for (fs::directory_iterator at(among, unreadable), end; !unreadable && at != end;
       at.increment(unreadable))
    if (at->path().filename().string().starts_with("isoline-") && is_of_a_dead_process(at->path()))
      fs::remove_all(at->path(), unreadable);
  constexpr int kMost = 1000;  // of this process, or of earlier ones with the same ID
  for (int i = 1; i <= kMost; ++i) {
    path_ = temporary_of(among / fmt::format("isoline-{}", i));
    if (mkdir(path_.c_str(), 0700) == 0) return;
    if (errno != EEXIST) break;
  }
  throw UsageError(
      fmt::format("cannot make a folder {}: {}", path_.string(), std::strerror(errno)));
}

HiddenFolder::~HiddenFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace isoline
