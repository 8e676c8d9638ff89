// The copies of a program that compute a problem: the first takes all calls, and the others share
// the forward passes that a method announces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/array.h"
#include "core/foreign/handshake.h"
#include "core/foreign/line.h"

namespace isoline {

// Seconds after which a call has failed where its problem sets no limit. A check sets them, or a
// simulator that never answers would keep it for ever.
inline double& call_seconds_otherwise() {
  static double seconds = kNoDeadline;
  return seconds;
}

class Workers {
 public:
  // Starts and greets the first program. The others start when there is work for them.
  Workers(SimulatorOptions given, std::uint64_t seed, OptionValues declared);

  const ProblemHandshake& said() const { return said_; }
  double most_seconds() const {  // of a call
    return given_.call_time > 0 ? given_.call_time : call_seconds_otherwise();
  }
  int starts() const { return workers_[0].starts; }  // of the first program

  // An announced call whose answer, or error, has come: at once, whether it will be taken or not.
  struct Finished {
    std::span<const Real> x, y;
    std::exception_ptr error;
    double seconds;
  };
  void on_finished(std::function<void(const Finished&)> act) { act_ = std::move(act); }

  // A call to the first program. LineError as Line has it.
  void ask(Verb verb, std::uint32_t point, std::span<const std::span<const Real>> numbers,
           std::span<Real> answer);
  void restart_if_lost();

  // The next forward passes, at these columns (k, count), under the number of a point that nothing
  // else uses. take() begins them.
  void announce(BatchRef x, std::uint32_t point);
  bool is_next(std::span<const Real> x) const;  // bit for bit
  // The answer of the next one, or its error, as ask() would have it. A program that was lost is
  // started again while the others go on.
  void take(std::span<Real> answer);

 private:
  // A copy is compared by a call to which the first program has answered. One that cannot start or
  // breaks the protocol is retired, and its call goes to another one.
  enum class State { absent, greeted, compared, idle, busy, lost, retired };
  struct Worker {
    std::unique_ptr<Line> line = nullptr;
    State state = State::absent;
    int starts = 0;
    bool is_examined = false;
    std::size_t call = 0;    // that it is busy with
    double waited = 0;       // seconds, for its greeting or its answer
    std::int64_t begun = 0;  // its call: monotonic nanoseconds
  };
  struct Call {
    Vector x, y;
    std::exception_ptr error = nullptr;
    bool is_done = false;
  };

  static bool is_awaited(const Worker& worker) {
    return worker.state == State::busy || worker.state == State::greeted ||
           worker.state == State::compared;
  }
  bool is_copy(const Worker& worker) const { return &worker != workers_.data(); }
  void launch(Worker& worker);
  void welcome(Worker& worker);
  void receive_greeting_of(Worker& worker);
  void examine(Worker& worker);
  void know(std::span<const Real> x, std::span<const Real> y);
  void compare(Worker& worker);
  void retire(Worker& worker, const char* why);
  void guarded(Worker& worker, const auto& work);
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
  std::function<void(const Finished&)> act_;
  std::vector<Call> calls_;
  std::size_t next_ = 0, begun_ = 0;  // calls_ before them were taken, and were handed out
  std::vector<std::size_t> again_;    // calls_ that retired copies gave back
  Vector known_x_, known_y_;          // an answer of the first program
  std::uint32_t point_ = 0;
};

}  // namespace isoline
