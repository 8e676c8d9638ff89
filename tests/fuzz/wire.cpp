// What another program writes into its socket: a handshake, answers, questions, or none of them.
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

#include "core/errors.h"
#include "core/foreign/handshake.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {
namespace {

// A line whose other end has written so much and hung up.
std::unique_ptr<Line> line_after(std::string_view bytes) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error("there is no socket");
  auto line = std::make_unique<Line>(ends[0]);
  const auto count = static_cast<std::size_t>(
      std::max(ssize_t{0}, ::send(ends[1], bytes.data(), bytes.size(), MSG_DONTWAIT)));
  ::close(ends[1]);
  if (count > bytes.size()) throw std::logic_error("more was written than there is");
  return line;
}

void expect_read_or_broken(const std::function<void()>& read) {
  expect_read_or_refused([&] {
    try {
      read();
    } catch (const LineError& error) {
      throw UsageError(error.what());
    }
  });
}

}  // namespace

void wire(std::string_view bytes) {
  const std::string text(bytes);
  expect_read_or_refused([&] { problem_handshake(text, "it"); });
  expect_read_or_refused([&] { method_handshake(text, "it"); });
  expect_read_or_broken([&] {
    const auto line = line_after(bytes);
    problem_handshake(line->receive_text(Verb::hello, kMostHandshake), line->who());
    std::array<Real, 3> answer{};
    for (;;) line->receive_answer(Verb::linearize, answer);
  });
  expect_read_or_broken([&] {
    const auto line = line_after(bytes);
    std::array<Real, 5> room{};
    for (;;)
      if (line->receive(room).bytes > sizeof room) throw std::logic_error("beyond the room");
  });
}

}  // namespace isoline::fuzz
