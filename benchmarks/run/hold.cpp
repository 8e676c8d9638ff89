// Record locks of POSIX: owned by the process, not by the open file.
#include "benchmarks/run/hold.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>

#include "core/digest.h"
#include "core/errors.h"

namespace isoline::benchmarks {
namespace {

bool lock(int descriptor, short kind, const std::string& cell) {
  struct flock one {};
  one.l_type = kind;
  one.l_whence = SEEK_SET;
  one.l_start = static_cast<off_t>(fnv1a(cell) >> 2);  // not negative, with room for the length
  one.l_len = 1;
  while (fcntl(descriptor, F_SETLK, &one) != 0) {
    if (errno == EACCES || errno == EAGAIN) return false;
    if (errno != EINTR) break;  // no locks here
  }
  return true;
}

// The locks within [begin, end), each a byte, counted by asking for one and then on either side.
std::size_t locks_between(int descriptor, off_t begin, off_t end) {
  if (begin >= end) return 0;
  struct flock one {};
  one.l_type = F_RDLCK;
  one.l_whence = SEEK_SET;
  one.l_start = begin;
  one.l_len = end - begin;
  if (fcntl(descriptor, F_GETLK, &one) != 0 || one.l_type == F_UNLCK) return 0;
  if (one.l_start < begin || one.l_start >= end) return 0;  // no lock of ours
  return 1 + locks_between(descriptor, begin, one.l_start) +
         locks_between(descriptor, one.l_start + 1, end);
}

}  // namespace

Holds::Holds(const std::filesystem::path& folder)
    : descriptor_(open((folder / "cells.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  require(descriptor_ >= 0, [&] {
    return fmt::format("cannot write in {}: {}", folder.string(), std::strerror(errno));
  });
}

Holds::~Holds() { close(descriptor_); }

bool Holds::take(const std::string& cell) { return lock(descriptor_, F_WRLCK, cell); }

void Holds::release(const std::string& cell) { lock(descriptor_, F_UNLCK, cell); }

std::size_t held_cells(const std::filesystem::path& folder) {
  const int descriptor = open((folder / "cells.lock").c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return 0;
  const std::size_t count = locks_between(descriptor, 0, std::numeric_limits<off_t>::max());
  close(descriptor);
  return count;
}

}  // namespace isoline::benchmarks
