// Several copies of a program, in one thread: it waits for whichever answers first.
#include "core/foreign/workers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "core/calls.h"
#include "core/clock.h"
#include "core/errors.h"

namespace isoline {
namespace {

constexpr double kTurn = 0.1, kMostCounted = 1;  // seconds; as of Line's deadlines

std::span<const Real> numbers_of(const Vector& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

}  // namespace

Workers::Workers(SimulatorOptions given, std::uint64_t seed, OptionValues declared)
    : given_(std::move(given)),
      seed_(seed),
      declared_(std::move(declared)),
      workers_(static_cast<std::size_t>(given_.workers)) {
  launch(workers_[0]);
  said_ = receive_greeting(*workers_[0].line, given_.startup);
  workers_[0].state = State::idle;
}

// The old program ends before the new one begins.
void Workers::launch(Worker& worker) {
  worker.state = State::lost;
  worker.line.reset();
  ChildProgram::Start start = door_to(given_.command);
  start.environment.emplace_back("ISOLINE_WORKER", std::to_string(&worker - workers_.data()));
  worker.line = std::make_unique<Line>(std::move(start));
  ++worker.starts;
  worker.waited = 0;
  send_greeting(*worker.line, seed_, declared_);
  worker.state = State::greeted;
}

void Workers::welcome(Worker& worker) {
  receive_greeting_of(worker);
  examine(worker);
}

// Asks an idle copy, once, what the first program has answered.
void Workers::examine(Worker& worker) {
  if (!is_copy(worker) || worker.state != State::idle || worker.is_examined || known_x_.size() == 0)
    return;
  worker.is_examined = true;
  worker.line->send(Verb::linearize, point_, numbers_of(known_x_));
  worker.waited = 0;
  worker.state = State::compared;
}

void Workers::know(std::span<const Real> x, std::span<const Real> y) {
  if (workers_.size() == 1 || known_x_.size() > 0) return;
  known_x_ = Eigen::Map<const Vector>(x.data(), std::ssize(x));
  known_y_ = Eigen::Map<const Vector>(y.data(), std::ssize(y));
}

void Workers::receive_greeting_of(Worker& worker) {
  const ProblemHandshake now = receive_greeting(*worker.line, given_.startup);
  if (now.inputs != said_.inputs || now.outputs != said_.outputs)
    worker.line->fail("has other numbers of inputs and outputs now that it was started again");
  worker.state = State::idle;
}

void Workers::restart_if_lost() {
  if (workers_[0].state != State::lost) return;
  launch(workers_[0]);
  welcome(workers_[0]);
}

// Where a copy fails in a way that would end the run, it ends alone.
void Workers::guarded(Worker& worker, const auto& work) {
  if (!is_copy(worker)) return work();
  try {
    work();
  } catch (const KilledProgram&) {
    throw;
  } catch (const std::exception& error) {
    retire(worker, error.what());
  }
}

void Workers::retire(Worker& worker, const char* why) {
  if (worker.state == State::busy) again_.push_back(worker.call);
  worker.state = State::retired;
  worker.line.reset();
  remark_on_calls(
      fmt::format("copy {} of the program is not used, and the run continues "
                  "with the others: {}",
                  &worker - workers_.data(), why));
}

// Compares its answer to a call that the first program has answered.
void Workers::compare(Worker& worker) {
  constexpr Real kRelative = 1e-9;
  Vector y(said_.outputs);
  worker.state = State::idle;
  try {
    worker.line->receive_answer(Verb::linearize, {y.data(), static_cast<std::size_t>(y.size())},
                                most_seconds());
  } catch (const LostProgram&) {
    throw;
  } catch (const FailedCall&) {
    y.setConstant(std::numeric_limits<Real>::quiet_NaN());
  }
  const Real most = kRelative * known_y_.cwiseAbs().maxCoeff<Eigen::PropagateNumbers>();
  const auto is_same = [&](Real a, Real b) {
    return a == b || (std::isnan(a) && std::isnan(b)) || std::abs(a - b) <= most;
  };
  if (std::ranges::equal(y, known_y_, is_same)) return;
  remark_on_calls(fmt::format(
      "copy {} of the program answers differently than the first one at the same x; with workers=1 "
      "there are no copies",
      &worker - workers_.data()));
}

void Workers::ask(Verb verb, std::uint32_t point, std::span<const std::span<const Real>> numbers,
                  std::span<Real> answer) {
  settle();
  Line& line = *workers_[0].line;
  try {
    line.send(verb, point, numbers);
    line.receive_answer(verb, answer, most_seconds());
    if (verb == Verb::linearize && std::cmp_equal(numbers[0].size(), said_.inputs))
      know(numbers[0], answer);
  } catch (const LostProgram&) {
    workers_[0].state = State::lost;
    throw;
  }
}

// Drops what was announced, and waits until the first program is free.
void Workers::settle() {
  begun_ = calls_.size();
  again_.clear();
  for (Worker& worker : workers_)
    guarded(worker, [&] {
      if (worker.state == State::compared)
        hear(worker, 0);
      else
        examine(worker);
    });
  while (workers_[0].state == State::busy || workers_[0].state == State::greeted) pump();
  next_ = calls_.size();
  restart_if_lost();
}

void Workers::announce(BatchRef x, std::uint32_t point) {
  begun_ = calls_.size();
  again_.clear();
  while (std::ranges::any_of(workers_, [](const Worker& w) { return w.state == State::busy; }))
    pump();  // of an announcement that was dropped
  calls_.clear();
  again_.clear();
  next_ = begun_ = 0;
  point_ = point;
  for (Index i = 0; i < x.cols(); ++i)
    calls_.push_back({.x = x.col(i), .y = Vector(said_.outputs)});
}

bool Workers::is_next(std::span<const Real> x) const {
  return next_ < calls_.size() && std::cmp_equal(x.size(), calls_[next_].x.size()) &&
         std::memcmp(x.data(), calls_[next_].x.data(), x.size_bytes()) == 0;
}

void Workers::take(std::span<Real> answer) {
  Call& call = calls_[next_];
  while (!call.is_done) pump();
  ++next_;
  if (call.error) std::rethrow_exception(call.error);
  std::ranges::copy(call.y, answer.begin());
}

// Calls go out in their order; those that are left start further programs.
void Workers::hand_out() {
  begun_ = std::max(begun_, next_);
  for (Worker& worker : workers_) {
    if (begun_ == calls_.size() && again_.empty()) return;
    guarded(worker, [&] { examine(worker); });
    if (worker.state != State::idle) continue;
    if (again_.empty()) {
      worker.call = begun_++;
    } else {
      worker.call = again_.back();
      again_.pop_back();
    }
    worker.waited = 0;
    worker.begun = monotonic_nanoseconds();
    worker.state = State::busy;
    const std::span<const Real> x = numbers_of(calls_[worker.call].x);
    try {
      worker.line->send(Verb::linearize, point_, x);
    } catch (...) {
      end_call(worker, [] { throw; });
    }
  }
  auto starting =
      static_cast<std::size_t>(std::ranges::count(workers_, State::greeted, &Worker::state));
  for (Worker& worker : workers_) {
    if (begun_ + starting >= calls_.size()) return;
    if (worker.state != State::absent) continue;
    guarded(worker, [&] {
      launch(worker);
      ++starting;
    });
  }
}

// One turn: an answer, or a tenth of a second.
void Workers::pump() {
  hand_out();
  std::vector<Line*> lines;
  for (const Worker& worker : workers_)
    if (is_awaited(worker)) lines.push_back(worker.line.get());
  const std::int64_t begin = monotonic_nanoseconds();
  Line::wait_for_any(lines, kTurn);
  const double turn =
      std::min(1e-9 * static_cast<double>(monotonic_nanoseconds() - begin), kMostCounted);
  for (Worker& worker : workers_)
    if (is_awaited(worker)) guarded(worker, [&] { hear(worker, turn); });
}

void Workers::hear(Worker& worker, double turn) {
  const bool is_greeted = worker.state == State::greeted;
  const double most = is_greeted ? given_.startup : most_seconds();
  const bool has_input = worker.line->has_input();
  if (!has_input) worker.waited += turn;
  const bool is_late = !has_input && worker.waited > most;
  if (!has_input && !is_late) return;
  if (worker.state == State::compared) {
    if (is_late) worker.line->fail_late(most);
    return compare(worker);
  }
  if (is_greeted) {
    require(!is_late, [&] {
      return fmt::format("{} did not answer within {} s", worker.line->sender(), most);
    });
    return welcome(worker);
  }
  end_call(worker, [&] {
    if (is_late) worker.line->fail_late(most);
    Vector& y = calls_[worker.call].y;
    worker.line->receive_answer(Verb::linearize, {y.data(), static_cast<std::size_t>(y.size())},
                                most);
  });
}

// The worker is free after a call, or starts again; with any other error, it takes no more calls.
void Workers::end_call(Worker& worker, const auto& exchange) {
  Call& call = calls_[worker.call];
  bool is_lost = false;
  worker.state = State::idle;
  try {
    exchange();
  } catch (const LostProgram&) {
    call.error = std::current_exception();
    is_lost = true;
  } catch (const FailedCall&) {
    call.error = std::current_exception();
  } catch (const KilledProgram&) {
    call.error = std::current_exception();
    worker.state = State::lost;
  } catch (const std::exception& error) {
    if (is_copy(worker)) {
      worker.state = State::busy;
      return retire(worker, error.what());
    }
    call.error = std::current_exception();
    worker.state = State::lost;
  }
  call.is_done = true;
  if (!is_copy(worker) && !call.error) know(numbers_of(call.x), numbers_of(call.y));
  const double seconds = 1e-9 * static_cast<double>(monotonic_nanoseconds() - worker.begun);
  act_({numbers_of(call.x), numbers_of(call.y), call.error, seconds});
  if (is_lost) guarded(worker, [&] { launch(worker); });
}

}  // namespace isoline
