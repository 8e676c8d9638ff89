// The frames between this program and another on a socket: a header of 16 bytes, then as many bytes
// as it states. All numbers are little-endian; a payload is doubles or UTF-8 text.
// docs/serving-problems.md has it to the byte.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/foreign/foreign.h"
#include "core/real.h"

namespace isoline {

static_assert(std::endian::native == std::endian::little, "frames are copied as they stand");

inline constexpr std::int64_t kWireProtocol = 1;
// Bytes of the longest text: a handshake holds vectors.
inline constexpr std::uint64_t kMostHandshake = std::uint64_t{64} << 20;
inline constexpr std::uint64_t kMostWireText = std::uint64_t{64} << 10;

enum class Verb : std::uint32_t {
  hello = 1,  // the handshake, both ways, as JSON
  // Requests to a problem. The status of the request is the number of a point.
  linearize = 2,    // x (k, B) -> y (m, B), and what products there need
  pushforward = 3,  // v (k, B) -> J v (m, B)
  pullback = 4,     // u (m, B) -> Jᵀ u (k, B)
  jacobian = 5,     // -> J of each sample side by side, (m, k·B)
  inverse = 6,      // y (m, B), x₀ (k, B) -> x (k, B), then a flag of success per sample
  x_error = 7,      // x (k) -> its distance from the nearest solution
  // The first message to an optimizer; then the optimizer sends requests, the point first.
  begin = 16,               // n and the count of residuals, as doubles; θ₀ (n)
  value = 17,               // θ -> L
  gradient = 18,            // θ -> ∇L (n)
  value_and_gradient = 19,  // θ -> L, ∇L
  residual = 20,            // θ -> r = (y − y*)/√B
  jacobian_of_r = 21,       // θ -> ∂r/∂θ, column by column
  pushforward_of_r = 22,    // θ, v (n) -> (∂r/∂θ) v
  pullback_of_r = 23,       // θ, w -> (∂r/∂θ)ᵀ w (n)
  hessian_product = 24,     // θ, v (n) -> ∇²L v
  report = 32,              // θ of an iteration -> nothing
  finish = 33,              // the θ to be judged -> nothing
  claim = 34,               // text: what it says of its own success -> nothing
};

// The status of an answer. A request has 0, or the number of a point.
enum class Answer : std::uint32_t {
  done = 0,
  failed = 1,  // the payload is why, as text
  stop = 2,    // to an optimizer: the run is over
};

struct FrameHead {
  std::uint32_t verb = 0, status = 0;
  std::uint64_t bytes = 0;
};
static_assert(sizeof(FrameHead) == 16);

std::string_view name_of(Verb verb);  // "pullback"; "an unknown verb"

// The other program broke off, or said what it must not. The text names it, how it ended and what
// it printed last.
struct LineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// So many calls in a row failed that the run ends.
struct CallsFailed : LineError {
  using LineError::LineError;
};

// Somebody killed the other program, or edited its files: it may be asked again.
struct KilledProgram : LineError {
  using LineError::LineError;
};

// The call failed, for this short reason, and the program waits for the next one.
struct FailedCall : LineError {
  FailedCall(const std::string& text, std::string why) : LineError(text), reason(std::move(why)) {}
  std::string reason;
};

// The program ended by itself or was late, so that it must be started again.
struct LostProgram : FailedCall {
  using FailedCall::FailedCall;
};

// It was late.
struct LateProgram : LostProgram {
  using LostProgram::LostProgram;
};

inline constexpr double kNoDeadline = std::numeric_limits<double>::infinity();

// A socket that frames go over, and the program at its other end, where this one started it.
class Line {
 public:
  // Starts the program, which finds its end of the line as a descriptor by ISOLINE_FD.
  explicit Line(ChildProgram::Start start);
  explicit Line(int socket);  // to one that runs already; takes the descriptor
  ~Line();
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  const std::string& sender() const { return sender_; }  // "`python3 mine.py`"

  void send(Verb verb, std::uint32_t status, std::span<const std::span<const Real>> numbers);
  void send(Verb verb, std::uint32_t status, std::span<const Real> numbers) {
    send(verb, status, std::span(&numbers, 1));
  }
  void send_text(Verb verb, std::uint32_t status, std::string_view text);

  // The next frame, its payload at the beginning of `room`. LineError if it is longer than that, or
  // does not arrive within so many seconds.
  FrameHead receive(std::span<Real> room, double seconds = kNoDeadline);
  // The answer to `verb`: exactly so many numbers. LineError where it is another, or failed.
  void receive_answer(Verb verb, std::span<Real> numbers, double seconds = kNoDeadline);
  std::string receive_text(Verb verb, std::uint64_t most_bytes, double seconds = kNoDeadline);

  // Whether something has arrived, or the program closed the connection.
  bool has_input() const;
  // Until one of them has input, at most so many seconds. Reads what the programs print.
  static void wait_for_any(std::span<Line* const> lines, double seconds);

  [[noreturn]] void fail(const std::string& what);  // with its name and its state
  [[noreturn]] void fail_late(double seconds);      // it did not answer within these
  [[noreturn]] void fail_at(Verb verb, const std::string& why);

 private:
  struct Deadline;
  struct Piece {
    const void* bytes;
    std::size_t count;
  };
  void send_pieces(const FrameHead& head, std::span<const Piece> pieces);
  FrameHead receive_head(void* room, std::size_t most, std::size_t& got, Deadline& deadline);
  void receive_rest(char* bytes, std::size_t count, Deadline& deadline);
  std::string message_text(const FrameHead& head, std::string begun, std::uint64_t most,
                           Deadline& deadline);
  std::string state_text() const;
  void wait(short events, Deadline& deadline);
  std::size_t receive_some(std::span<const std::span<char>> parts, Deadline& deadline);

  int socket_ = -1;
  std::unique_ptr<ChildProgram> child_;
  std::string sender_;
};

}  // namespace isoline
