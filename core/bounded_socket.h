// A connected socket whose other side may be slow, silent or endless: what is read has a number of
// bytes and a deadline, what is written has the same deadline.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace isoline {

class BoundedSocket {
 public:
  explicit BoundedSocket(int descriptor) : descriptor_(descriptor) {}
  ~BoundedSocket();  // closes it
  BoundedSocket(const BoundedSocket&) = delete;
  BoundedSocket& operator=(const BoundedSocket&) = delete;

  int descriptor() const { return descriptor_; }

  // From now on: so many bytes may be read, all that is read and written within so many seconds,
  // and none of them may be waited for longer than `idle`.
  void allow(std::size_t bytes, double seconds, double idle);
  // Another number of bytes, the time as it is.
  void allow_bytes(std::size_t bytes) { bytes_left_ = bytes; }
  std::size_t bytes_left() const { return bytes_left_; }

  bool can_be_read(double seconds);  // within that time, by the deadline or not

  // As read(2): 0 at the end and where no more bytes are allowed, −1 where the time is over.
  ssize_t read(char* out, std::size_t size);
  // Kept until `flush`, or until something is to be read.
  bool write(std::string_view bytes);
  bool flush();

  // Says that nothing more will be written, and reads on for a moment: who is told why it was
  // refused while it still writes would else lose the answer with the connection.
  void close_gently();

 private:
  bool wait(short events, double seconds) const;
  double seconds_left() const;
  bool fill();

  int descriptor_;
  std::array<char, 16384> in_;
  std::size_t in_begin_ = 0, in_end_ = 0, bytes_left_ = 0;
  std::string out_;
  std::int64_t deadline_ = 0;  // monotonic nanoseconds
  double idle_ = 0;
};

}  // namespace isoline
