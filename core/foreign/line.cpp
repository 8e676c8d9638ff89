// Names of the requests in frames.
#include "core/foreign/line.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "core/clock.h"
#include "core/errors.h"
#include "core/text.h"

namespace isoline {
namespace {

constexpr std::array<std::pair<Verb, std::string_view>, 19> kNames{{
    {Verb::hello, "handshake"},
    {Verb::linearize, "linearize"},
    {Verb::pushforward, "pushforward"},
    {Verb::pullback, "pullback"},
    {Verb::jacobian, "jacobian"},
    {Verb::inverse, "inverse"},
    {Verb::x_error, "x_error"},
    {Verb::begin, "begin"},
    {Verb::value, "value"},
    {Verb::gradient, "gradient"},
    {Verb::value_and_gradient, "value_and_gradient"},
    {Verb::residual, "residual"},
    {Verb::jacobian_of_r, "jacobian"},
    {Verb::pushforward_of_r, "pushforward"},
    {Verb::pullback_of_r, "pullback"},
    {Verb::hessian_product, "hessian_product"},
    {Verb::report, "report"},
    {Verb::finish, "finish"},
    {Verb::claim, "claim"},
}};

// An answer that comes soon is met awake: to be woken takes as long as it does itself.
constexpr std::int64_t kSpinNanoseconds = 20'000;
constexpr std::size_t kMostPieces = 5;

std::span<char> bytes_of(std::span<Real> numbers) {
  return {reinterpret_cast<char*>(numbers.data()), numbers.size_bytes()};
}

}  // namespace

std::string_view name_of(Verb verb) {
  const auto* const found =
      std::ranges::find(kNames, verb, &std::pair<Verb, std::string_view>::first);
  return found == kNames.end() ? "an unknown verb" : found->second;
}

// Frames over a socket of the Unix domain: whole in one call where the system lets it, waited for
// by a short spin and then by poll.

// Waits in short turns. One that lasted much longer was a pause (Ctrl-Z), which hardly counts.
struct Line::Deadline {
  static constexpr double kTurn = 0.1, kMostCounted = 1;  // seconds

  double seconds, waited = 0;
  std::int64_t last = monotonic_nanoseconds();

  int milliseconds_to_wait() const {  // −1: for ever
    if (seconds == kNoDeadline) return -1;
    return static_cast<int>(1e3 * std::clamp(seconds - waited, 0.0, kTurn) + 1);
  }
  void count() {
    const std::int64_t now = monotonic_nanoseconds();
    waited += std::min(1e-9 * static_cast<double>(now - last), kMostCounted);
    last = now;
  }
  bool is_over() const { return seconds != kNoDeadline && waited > seconds; }
};

Line::Line(ChildProgram::Start start) : sender_("`" + start.command + "`") {
  int ends[2];
  require(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0,
          "cannot create another socket for a program");
  socket_ = ends[0];
  start.descriptor = ends[1];
  start.environment.emplace_back("ISOLINE_FD", std::to_string(ends[1]));
  try {
    child_ = std::make_unique<ChildProgram>(start);
  } catch (...) {
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  close(ends[1]);
}

Line::Line(int socket) : socket_(socket), sender_("the other program") {}

Line::~Line() { close(socket_); }

std::string Line::state_text() const {
  if (!child_) return "";
  const std::string end = child_->end_in_words(), words = child_->last_words();
  return fmt::format("; {}{}", end,
                     words.empty() ? ", and printed nothing" : "; its last output was: " + words);
}

void Line::fail(const std::string& what) {
  const std::string text = fmt::format("{} {}{}", sender_, what, state_text());
  if (child_ && child_->was_killed()) throw KilledProgram(text);
  if (child_ && child_->has_ended()) throw LostProgram(text, child_->end_in_words());
  throw LineError(text);
}

void Line::fail_at(Verb verb, const std::string& why) {
  throw FailedCall(fmt::format("{} failed at {}: {}", sender_, name_of(verb), why), why);
}

// Reads the program's output while waiting, so that a full pipe does not block the program.
void Line::wait(short events, Deadline& deadline) {
  std::array<pollfd, 2> watched{
      {{socket_, events, 0}, {child_ ? child_->output() : -1, POLLIN, 0}}};
  poll(watched.data(), watched.size(), deadline.milliseconds_to_wait());
  deadline.count();
  if (child_ && watched[1].revents != 0) child_->drain();
  if (watched[0].revents == 0 && deadline.is_over()) fail_late(deadline.seconds);
}

void Line::fail_late(double seconds) {
  throw LateProgram(fmt::format("{} did not answer within {} s{}", sender_, seconds, state_text()),
                    fmt::format("it did not answer within {} s", seconds));
}

bool Line::has_input() const {
  pollfd watched{socket_, POLLIN, 0};
  return poll(&watched, 1, 0) > 0;
}

void Line::wait_for_any(std::span<Line* const> lines, double seconds) {
  std::vector<pollfd> watched;
  for (const Line* line : lines) {
    watched.push_back({line->socket_, POLLIN, 0});
    watched.push_back({line->child_ ? line->child_->output() : -1, POLLIN, 0});
  }
  poll(watched.data(), watched.size(), static_cast<int>(1e3 * seconds));
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (watched[2 * i + 1].revents != 0 && lines[i]->child_) lines[i]->child_->drain();
}

void Line::send_pieces(const FrameHead& head, std::span<const Piece> pieces) {
  char early = 0;  // an unsolicited answer would be taken for the next one
  if (recv(socket_, &early, 1, MSG_PEEK | MSG_DONTWAIT) > 0)
    fail("sent data that was not requested");
  std::array<Piece, kMostPieces> left{};
  std::size_t count = 0;
  left[count++] = {&head, sizeof head};
  for (const Piece& piece : pieces)
    if (piece.count > 0) left.at(count++) = piece;
  Deadline forever{kNoDeadline};
  for (std::size_t first = 0; first < count;) {
    std::array<iovec, kMostPieces> parts{};
    for (std::size_t i = first; i < count; ++i)
      parts[i] = {const_cast<void*>(left[i].bytes), left[i].count};
    msghdr message{};
    message.msg_iov = &parts[first];
    message.msg_iovlen = count - first;
    const ssize_t sent = sendmsg(socket_, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) {
      wait(POLLOUT, forever);
      continue;
    }
    if (sent < 0) fail("closed the connection");
    auto taken = static_cast<std::size_t>(sent);
    for (; first < count && taken >= left[first].count; ++first) taken -= left[first].count;
    if (first < count)
      left[first] = {static_cast<const char*>(left[first].bytes) + taken,
                     left[first].count - taken};
  }
}

void Line::send(Verb verb, std::uint32_t status, std::span<const std::span<const Real>> numbers) {
  std::array<Piece, kMostPieces - 1> pieces{};
  FrameHead head{static_cast<std::uint32_t>(verb), status, 0};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    pieces.at(i) = {numbers[i].data(), numbers[i].size_bytes()};
    head.bytes += numbers[i].size_bytes();
  }
  send_pieces(head, std::span(pieces).first(numbers.size()));
}

void Line::send_text(Verb verb, std::uint32_t status, std::string_view text) {
  const Piece piece{text.data(), text.size()};
  send_pieces({static_cast<std::uint32_t>(verb), status, text.size()}, std::span(&piece, 1));
}

// At least a byte of them.
std::size_t Line::receive_some(std::span<const std::span<char>> parts, Deadline& deadline) {
  std::array<iovec, 2> room{};
  for (std::size_t i = 0; i < parts.size(); ++i) room.at(i) = {parts[i].data(), parts[i].size()};
  msghdr message{};
  message.msg_iov = room.data();
  message.msg_iovlen = parts.size();
  const std::int64_t begin = monotonic_nanoseconds();
  for (;;) {
    const ssize_t got = recvmsg(socket_, &message, MSG_DONTWAIT);
    if (got > 0) return static_cast<std::size_t>(got);
    if (got == 0) fail("closed the connection");
    if (errno != EAGAIN && errno != EINTR) fail("closed the connection");
    if (monotonic_nanoseconds() - begin > kSpinNanoseconds) wait(POLLIN, deadline);
  }
}

// The header, and the bytes that arrive with it in `room`: `got` bytes of the payload.
FrameHead Line::receive_head(void* room, std::size_t most, std::size_t& got, Deadline& deadline) {
  FrameHead head;
  char* const bytes = reinterpret_cast<char*>(&head);
  std::size_t read = 0;
  while (read < sizeof head) {
    const std::array<std::span<char>, 2> parts{
        {{bytes + read, sizeof head - read}, {static_cast<char*>(room), most}}};
    read += receive_some(std::span(parts).first(most > 0 ? 2 : 1), deadline);
  }
  got = read - sizeof head;
  if (got > head.bytes) fail("sent more bytes than the header of its frame states");
  return head;
}

void Line::receive_rest(char* bytes, std::size_t count, Deadline& deadline) {
  while (count > 0) {
    const std::array<std::span<char>, 1> part{{{bytes, count}}};
    const std::size_t got = receive_some(part, deadline);
    bytes += got;
    count -= got;
  }
}

std::string Line::message_text(const FrameHead& head, std::string begun, std::uint64_t most,
                               Deadline& deadline) {
  if (head.bytes > most)
    fail(fmt::format("sent a string of {} bytes; at most {} bytes are allowed", head.bytes, most));
  const std::size_t got = begun.size();
  begun.resize(head.bytes);
  receive_rest(begun.data() + got, begun.size() - got, deadline);
  return valid_utf8(begun);
}

FrameHead Line::receive(std::span<Real> room, double seconds) {
  Deadline deadline{seconds};
  const std::span<char> bytes = bytes_of(room);
  std::size_t got = 0;
  const FrameHead head = receive_head(bytes.data(), bytes.size(), got, deadline);
  if (head.bytes > bytes.size())
    fail(fmt::format("sent a frame of {} bytes; at most {} bytes are allowed here", head.bytes,
                     bytes.size()));
  receive_rest(bytes.data() + got, head.bytes - got, deadline);
  return head;
}

void Line::receive_answer(Verb verb, std::span<Real> numbers, double seconds) {
  Deadline deadline{seconds};
  const std::span<char> bytes = bytes_of(numbers);
  std::size_t got = 0;
  const FrameHead head = receive_head(bytes.data(), bytes.size(), got, deadline);
  if (head.verb != static_cast<std::uint32_t>(verb))
    fail(fmt::format("answered {} with a frame of verb {}", name_of(verb), head.verb));
  if (head.status != static_cast<std::uint32_t>(Answer::done))
    fail_at(verb, message_text(head, {bytes.data(), got}, kMostWireText, deadline));
  if (head.bytes != bytes.size())
    fail(fmt::format("answered {} with {} bytes instead of {}", name_of(verb), head.bytes,
                     bytes.size()));
  receive_rest(bytes.data() + got, bytes.size() - got, deadline);
}

std::string Line::receive_text(Verb verb, std::uint64_t most_bytes, double seconds) {
  Deadline deadline{seconds};
  std::size_t got = 0;
  const FrameHead head = receive_head(nullptr, 0, got, deadline);
  if (head.verb != static_cast<std::uint32_t>(verb))
    fail(fmt::format("answered {} with a frame of verb {}", name_of(verb), head.verb));
  const std::string text = message_text(head, "", most_bytes, deadline);
  if (head.status != static_cast<std::uint32_t>(Answer::done)) fail_at(verb, text);
  return text;
}

}  // namespace isoline
