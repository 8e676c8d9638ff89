// Record locks of POSIX: owned by the process, not by the open file.
#include "benchmarks/run/hold.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

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

}  // namespace isoline::benchmarks
