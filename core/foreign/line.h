// A line to another program: a socket that frames go over, and the program at its other end, where
// this one started it.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "core/foreign/child.h"
#include "core/foreign/wire.h"
#include "core/real.h"

namespace isoline {

// The other program broke off, or said what it must not. The text names it, how it ended and what
// it printed last.
struct LineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline constexpr double kNoDeadline = std::numeric_limits<double>::infinity();

class Line {
 public:
  // Starts the program, which finds its end of the line as a descriptor by ISOLINE_FD.
  explicit Line(ChildProgram::Start start);
  explicit Line(int socket);  // to one that runs already; takes the descriptor
  ~Line();
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  const std::string& who() const { return who_; }  // "`python3 mine.py`"

  void send(Verb verb, std::uint32_t status, std::span<const std::span<const Real>> numbers);
  void send(Verb verb, std::uint32_t status, std::span<const Real> numbers) {
    send(verb, status, std::span(&numbers, 1));
  }
  void send_text(Verb verb, std::uint32_t status, std::string_view text);

  // The next frame, its payload at the beginning of `room`. LineError where it is longer than that,
  // or does not come within so many seconds.
  FrameHead receive(std::span<Real> room, double seconds = kNoDeadline);
  // The answer to `verb`: exactly so many numbers. LineError where it is another, or failed.
  void receive_answer(Verb verb, std::span<Real> numbers, double seconds = kNoDeadline);
  std::string receive_text(Verb verb, std::uint64_t most_bytes, double seconds = kNoDeadline);

  [[noreturn]] void fail(const std::string& what);  // with who it is and how it fares

 private:
  struct Deadline;
  struct Piece {
    const void* bytes;
    std::size_t count;
  };
  void send_pieces(const FrameHead& head, std::span<const Piece> pieces);
  FrameHead receive_head(void* room, std::size_t most, std::size_t& got, const Deadline& deadline);
  void receive_rest(char* bytes, std::size_t count, const Deadline& deadline);
  std::string text_of(const FrameHead& head, std::string begun, std::uint64_t most,
                      const Deadline& deadline);
  void wait(short events, const Deadline& deadline);
  std::size_t receive_some(std::span<const std::span<char>> parts, const Deadline& deadline);

  int socket_ = -1;
  std::unique_ptr<ChildProgram> child_;
  std::string who_;
};

}  // namespace isoline
