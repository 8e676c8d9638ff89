// An optimizer in C or C++ as a program that Isoline starts, by the frames of
// docs/serving-problems.md.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

class Peer {
 public:
  using Vector = std::vector<double>;

  struct Said {
    std::string name;
    std::string needs;  // as JSON: "\"pullback\""
    bool least_squares = false, keeps_bounds = false;
    double failed =
        1e100;  // a value, or each residual, where an evaluation fails; slopes are 0 there
  };

  explicit Peer(const Said& said) : failed_(said.failed) {
    const char* const descriptor = std::getenv("ISOLINE_FD");
    if (descriptor == nullptr) {
      std::fputs("Isoline starts this program: process[command=…]\n", stderr);
      std::exit(1);
    }
    socket_ = std::atoi(descriptor);
    receive();
    const auto flag = [](bool is_set) { return is_set ? "true" : "false"; };
    char note[100];
    std::snprintf(note, sizeof note,
                  "Where an evaluation fails, the library is given values of %g.", failed_);
    const std::string text = R"({"protocol":1,"role":"optimizer","name":")" + said.name +
                             R"(","needs":[)" + said.needs + R"(],"least_squares":)" +
                             flag(said.least_squares) + R"(,"keeps_bounds":)" +
                             flag(said.keeps_bounds) + R"(,"note":")" + note + "\"}";
    send(kHello, text.data(), text.size());
    const Vector begun = receive();
    n = static_cast<std::size_t>(begun[0]);
    m = static_cast<std::size_t>(begun[1]);
    const auto part = [&](std::size_t i) {
      return Vector(&begun[2 + i * n], &begun[2 + i * n] + n);
    };
    const bool has_bounds = begun.size() > n + 2;
    x0 = part(0);
    lower = has_bounds ? part(1) : Vector(n, -HUGE_VAL);
    upper = has_bounds ? part(2) : Vector(n, HUGE_VAL);
  }

  double value(const double* x) { return ask(kValue, x, failed_)[0]; }
  double value(const double* x, double* gradient) {
    const Vector slope = ask(kGradient, x, 0);
    std::copy(slope.begin(), slope.end(), gradient);
    return value(x);
  }
  Vector residual(const double* x) { return ask(kResidual, x, failed_); }
  Vector jacobian(const double* x) { return ask(kJacobian, x, 0); }  // ∂r/∂x, column by column

  void finish(const double* x, const std::string& words) {
    send(kClaim, words.data(), words.size());
    receive();
    ask(kFinish, x, 0);
  }

  std::size_t n = 0, m = 0;
  Vector x0, lower, upper;  // (n)

 private:
  enum : std::uint32_t {
    kHello = 1,
    kValue = 17,
    kGradient,
    kResidual = 20,
    kJacobian,
    kFinish = 33,
    kClaim
  };
  struct Head {
    std::uint32_t verb, status;
    std::uint64_t bytes;
  };

  Vector ask(std::uint32_t verb, const double* x, double failed) {
    send(verb, x, n * sizeof *x);
    Vector numbers = receive();
    for (const double each : numbers)
      if (!std::isfinite(each)) return Vector(numbers.size(), failed);
    return numbers;
  }
  void send(std::uint32_t verb, const void* bytes, std::size_t count) {
    std::vector<char> frame(sizeof(Head) + count);
    const Head head{verb, 0, count};
    std::copy_n(reinterpret_cast<const char*>(&head), sizeof head, frame.data());
    std::copy_n(static_cast<const char*>(bytes), count, frame.data() + sizeof head);
    for (std::size_t sent = 0; sent < frame.size();) {
      const ssize_t more = write(socket_, &frame[sent], frame.size() - sent);
      if (more <= 0) std::exit(0);
      sent += static_cast<std::size_t>(more);
    }
  }
  void read_whole(void* bytes, std::size_t count) {
    for (std::size_t got = 0; got < count;) {
      const ssize_t more = read(socket_, static_cast<char*>(bytes) + got, count - got);
      if (more <= 0) std::exit(0);  // Isoline has closed the socket
      got += static_cast<std::size_t>(more);
    }
  }
  Vector receive() {
    Head head;
    read_whole(&head, sizeof head);
    std::string text(head.bytes, '\0');
    read_whole(text.data(), text.size());
    if (head.status == 2) std::exit(0);  // the run is over
    if (head.status == 1) std::fprintf(stderr, "%s\n", text.c_str()), std::exit(1);
    Vector numbers(text.size() / sizeof(double));
    std::copy_n(text.data(), numbers.size() * sizeof(double),
                reinterpret_cast<char*>(numbers.data()));
    return numbers;
  }

  int socket_ = -1;
  double failed_;
};
