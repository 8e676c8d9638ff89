// Files by the calls of the system, whose every answer is looked at.
#include "core/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/errors.h"

namespace isoline {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const char* what, const fs::path& path) {
  throw std::runtime_error(fmt::format("cannot {} {}: {}", what, path.string(), strerror(errno)));
}

// An open file, closed with its scope; `close` tells whether that went well.
class OpenFile {
 public:
  OpenFile(const fs::path& path, int how, const char* what)
      : descriptor_(::open(path.c_str(), how | O_CLOEXEC, 0644)) {
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

void write_new(const fs::path& path, std::string_view text, bool is_flushed) {
  OpenFile file(path, O_WRONLY | O_CREAT | O_TRUNC, "create");
  write_all(file.descriptor(), text, path);
  if (is_flushed && ::fsync(file.descriptor()) != 0) fail("flush", path);
  if (!file.close()) fail("close", path);
}

}  // namespace

std::string read_text(const fs::path& path) {
  constexpr std::size_t kChunk = 1 << 16;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::string text;
  ssize_t count = file < 0 ? -1 : 1;
  while (count > 0) {
    const std::size_t size = text.size();
    text.resize(size + kChunk);
    while ((count = ::read(file, text.data() + size, kChunk)) < 0 && errno == EINTR) continue;
    text.resize(size + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  }
  if (file >= 0) ::close(file);
  if (count < 0) throw UsageError(fmt::format("cannot read {}", path.string()));
  return text;
}

void write_text(const fs::path& path, std::string_view text) {
  const fs::path temporary = path.string() + fmt::format(".{}.tmp", ::getpid());
  try {
    write_new(temporary, text, true);
    if (::rename(temporary.c_str(), path.c_str()) != 0) fail("rename to", path);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
}

void write_unflushed(const fs::path& path, std::string_view text) { write_new(path, text, false); }

void flush_all(const fs::path& folder) {
  const OpenFile file(folder, O_RDONLY | O_DIRECTORY, "open");
  if (::syncfs(file.descriptor()) != 0) fail("flush", folder);
}

}  // namespace isoline
