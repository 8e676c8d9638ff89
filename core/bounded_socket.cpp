// Reads and writes that end, whatever the other side does.
#include "core/bounded_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/clock.h"

namespace isoline {
namespace {

constexpr std::size_t kMostKept = 1 << 16;  // bytes that wait to be written together

bool must_wait() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

BoundedSocket::~BoundedSocket() { ::close(descriptor_); }

void BoundedSocket::allow(std::size_t bytes, double seconds, double idle) {
  bytes_left_ = bytes;
  idle_ = idle;
  deadline_ = monotonic_nanoseconds() + static_cast<std::int64_t>(seconds * 1e9);
}

double BoundedSocket::seconds_left() const {
  return 1e-9 * static_cast<double>(deadline_ - monotonic_nanoseconds());
}

bool BoundedSocket::wait(short events, double seconds) const {
  pollfd waiting{descriptor_, events, 0};
  const int milliseconds = static_cast<int>(std::clamp(seconds * 1e3, 0.0, 1e9));
  return ::poll(&waiting, 1, milliseconds) > 0;
}

bool BoundedSocket::can_be_read(double seconds) {
  return in_begin_ < in_end_ || wait(POLLIN, seconds);
}

// False where the time is over; at the end nothing is there.
bool BoundedSocket::fill() {
  if (!flush()) return false;
  in_begin_ = in_end_ = 0;
  while (seconds_left() > 0) {
    const ssize_t got = ::recv(descriptor_, in_.data(), in_.size(), MSG_DONTWAIT);
    if (got >= 0) {
      in_end_ = static_cast<std::size_t>(got);
      return true;
    }
    if (!must_wait() || !wait(POLLIN, std::min(idle_, seconds_left()))) return false;
  }
  return false;
}

ssize_t BoundedSocket::read(char* out, std::size_t size) {
  if (bytes_left_ == 0) return 0;
  if (in_begin_ == in_end_ && !fill()) return -1;
  const std::size_t count = std::min({size, in_end_ - in_begin_, bytes_left_});
  std::memcpy(out, in_.data() + in_begin_, count);
  in_begin_ += count;
  bytes_left_ -= count;
  return static_cast<ssize_t>(count);
}

bool BoundedSocket::write(std::string_view bytes) {
  out_ += bytes;
  return out_.size() < kMostKept || flush();
}

bool BoundedSocket::flush() {
  std::string_view left = out_;
  while (!left.empty()) {
    const ssize_t sent = ::send(descriptor_, left.data(), left.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent > 0) left.remove_prefix(static_cast<std::size_t>(sent));
    if (sent >= 0) continue;
    const double seconds = std::min(idle_, seconds_left());
    if (!must_wait() || seconds <= 0 || !wait(POLLOUT, seconds)) break;
  }
  const bool is_done = left.empty();
  out_.clear();
  return is_done;
}

void BoundedSocket::close_gently() {
  constexpr double kMostSeconds = 1, kPause = 0.1;
  allow(0, kMostSeconds, kMostSeconds);
  if (!flush() || ::shutdown(descriptor_, SHUT_WR) != 0) return;
  while (seconds_left() > 0 && wait(POLLIN, kPause))
    if (::recv(descriptor_, in_.data(), in_.size(), MSG_DONTWAIT) <= 0) return;
}

}  // namespace isoline
