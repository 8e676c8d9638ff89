// The copies of a program that compute a problem: the first takes all calls, and the others share
// the forward passes that a method announces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <vector>

#include "core/array.h"
#include "core/foreign/handshake.h"
#include "core/foreign/line.h"

namespace isoline {

class Workers {
 public:
  // Starts and greets the first program. The others start when there is work for them.
  Workers(SimulatorOptions given, std::uint64_t seed, OptionValues declared);

  const ProblemHandshake& said() const { return said_; }
  int starts() const { return workers_[0].starts; }  // of the first program

  // A call to the first program. LineError as Line has it.
  void ask(Verb verb, std::uint32_t point, std::span<const std::span<const Real>> numbers,
           std::span<Real> answer);
  void restart_if_lost();

  // The next forward passes, at these columns (k, count), under the number of a point that nothing
  // else uses. take() begins them.
  void announce(BatchRef x, std::uint32_t point);
  bool is_next(std::span<const Real> x) const;  // bit for bit
  void skip() { ++next_; }                      // the next one, whose answer is known
  // The answer of the next one, or its error, as ask() would have it. A program that was lost is
  // started again while the others go on.
  void take(std::span<Real> answer);

 private:
  enum class State { absent, greeted, idle, busy, lost };
  struct Worker {
    std::unique_ptr<Line> line = nullptr;
    State state = State::absent;
    int starts = 0;
    std::size_t call = 0;  // that it is busy with
    double waited = 0;     // seconds, for its greeting or its answer
  };
  struct Call {
    Vector x, y;
    std::exception_ptr error = nullptr;
    bool is_done = false;
  };

  double most_seconds() const { return given_.call_time > 0 ? given_.call_time : kNoDeadline; }
  void launch(Worker& worker);
  void welcome(Worker& worker);
  void settle();
  void pump();
  void hand_out();
  void hear(Worker& worker, double turn);
  void end_call(Worker& worker, const auto& exchange);

  SimulatorOptions given_;
  std::uint64_t seed_;
  OptionValues declared_;
  std::vector<Worker> workers_;
  ProblemHandshake said_;
  std::vector<Call> calls_;
  std::size_t next_ = 0, begun_ = 0;  // calls_ before them were taken, and were handed out
  std::uint32_t point_ = 0;
};

}  // namespace isoline
