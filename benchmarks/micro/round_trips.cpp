// The overhead of the process adapter for a round trip of a frame: a forward of a program
// that returns its x, over the bare frames of one that sends them back.
#include <cstdlib>

#include "benchmarks/micro/pairs.h"
#include "core/foreign/handshake.h"

namespace isoline::benchmarks::micro {

using problems::Point;
namespace {

constexpr int kCalls = 50;

// With NumPy, where an interpreter has it.
const std::string& python() {
  static const std::string found = [] {
    for (const std::string each : {"python3", "/usr/bin/python3"})
      if (std::system((each + " -c 'import numpy' >/dev/null 2>&1").c_str()) == 0) return each;
    return std::string("python3");
  }();
  return found;
}

std::string command_of(const char* script, Index n) {
  return python() + " " ISOLINE_SOURCE_DIR "/benchmarks/micro/" + script + " " + std::to_string(n);
}

struct Forward {
  explicit Forward(Index n)
      : problem(make_problem("process[command=" + quoted(command_of("echo.py", n)) + "]")) {
    problem.forward(problem.start(), at);
  }
  Cost cost() {
    return cost_of(kCalls, [&] { problem.forward(problem.start(), at); });
  }

  Problem problem;
  Point at;
};

struct Frames {
  explicit Frames(Index n) : line(door_to(command_of("echo_frames.py", n))), numbers(n) {
    numbers.setZero();
  }
  Cost cost() {
    const std::span<Real> all(numbers.data(), static_cast<std::size_t>(numbers.size()));
    return cost_of(kCalls, [&] {
      line.send(Verb::linearize, 0, std::span<const Real>(all));
      line.receive_answer(Verb::linearize, all);
    });
  }

  Line line;
  Vector numbers;
};

}  // namespace

void register_round_trips() {
  // Promised are 15 and 40 µs of a round trip, where bare frames were measured to take 6 and 17.
  for (const auto& [n, ratio] : {std::pair<Index, double>{2, 15.0 / 6}, {4096, 40.0 / 17}})
    register_pair("door/forward/n=" + std::to_string(n), 201, {.ratio = ratio}, [n = n] {
      const auto ours = std::make_shared<Forward>(n);
      const auto bare = std::make_shared<Frames>(n);
      return Pair{[=] { return ours->cost(); }, [=] { return bare->cost(); }};
    });
}

}  // namespace isoline::benchmarks::micro
