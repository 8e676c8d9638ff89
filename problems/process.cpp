// A problem that another program computes, over frames on a private socket
// (docs/serving-problems.md): process[command="python3 mine.py"]. Each problem object has its own
// program, which ends with it. A point needs one forward; the products there use its results.
#include <fmt/format.h>

#include <array>
#include <limits>

#include "core/array.h"
#include "core/clock.h"
#include "core/failures.h"
#include "core/foreign/evaluations.h"
#include "core/foreign/handshake.h"
#include "core/foreign/workers.h"
#include "problems/differences.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

Inverse inverse_of(const std::string& kind) {
  if (kind == "exact") return Inverse::exact;
  if (kind == "damped") return Inverse::damped;
  if (kind == "estimate") return Inverse::estimate;
  return kind.empty() ? Inverse::none : Inverse::approximate;
}

constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN();
constexpr const char* kNotFinite = "y is not finite";

// The programs, and the points that the first one remembers, by number: one for every workspace
// that is linearized at. A program that ended, or was late, is started again and remembers no
// point.
class Session {
 public:
  Session(const SimulatorOptions& given, std::uint64_t seed, const OptionValues& declared)
      : has_several_(given.workers > 1),
        has_call_time_(given.call_time > 0),
        workers_(given, seed, declared),
        key_(given.command, declared, seed),
        failures_allowed_(given.failures > 0 ? given.failures
                                             : std::max<Index>(100, 10 * said().inputs)),
        announced_point_(take_point()) {
    workers_.on_finished([this](const Workers::Finished& call) { keep_announced(call); });
  }

  const ProblemHandshake& said() const { return workers_.said(); }
  int starts() const { return workers_.starts(); }

  // Why the call failed; empty if it did not.
  // From the store of evaluations, if it has this one; else from a program, after `prepare(start)`,
  // which says why it failed: start of the first program, or kNowhere where another one may answer,
  // and no program knows the point. `x` is the point of a product.
  std::string call(Verb verb, std::uint32_t number, std::span<const Real> sent,
                   std::span<Real> answer, const auto& prepare, std::span<const Real> x = {}) {
    const std::array<std::span<const Real>, 2> request = {x, sent};
    return call(verb, number, std::span(&sent, 1), request, answer, prepare);
  }
  std::string call(Verb verb, std::uint32_t number, std::span<const std::span<const Real>> sent,
                   Evaluations::Numbers request, std::span<Real> answer, const auto& prepare) {
    Evaluations& store = evaluations();
    if (!Afresh::is_on())
      if (const auto why = store.find(key_, verb, request, answer, workers_.most_seconds())) {
        count_failure(verb, *why, answer);
        has_answered_ = has_answered_ || why->empty();
        return *why;
      }
    const bool is_announced = verb == Verb::linearize && workers_.is_next(sent[0]);
    if (std::string why = prepare(is_announced ? kNowhere : starts()); !why.empty()) return why;
    const std::int64_t begin = monotonic_nanoseconds();
    is_late_ = false;
    const std::string why = is_announced ? answered(verb, answer, [&] { workers_.take(answer); })
                                         : ask_program(verb, number, sent, answer);
    if (!is_announced)
      keep(verb, request, answer, why, 1e-9 * static_cast<double>(monotonic_nanoseconds() - begin),
           is_late_, !has_own_products());
    if (Afresh::is_on() && verb == Verb::linearize) {
      ++call_report().afresh;
      if (!why.empty()) ++call_report().afresh_failed;
    }
    return why;
  }

  // The call to the first program, without the store.
  std::string ask_program(Verb verb, std::uint32_t number,
                          std::span<const std::span<const Real>> numbers, std::span<Real> answer) {
    ++call_report().made;
    const std::string why =
        answered(verb, answer, [&] { workers_.ask(verb, number, numbers, answer); });
    workers_.restart_if_lost();
    return why;
  }

  // Without those that the store has.
  void announce(BatchRef x) {
    if (!has_several_) return;
    Matrix left(x.rows(), x.cols());
    Index count = 0;
    for (Index b = 0; b < x.cols(); ++b) {
      left.col(count) = x.col(b);
      const std::array<std::span<const Real>, 2> request = {
          std::span<const Real>(), {left.col(count).data(), static_cast<std::size_t>(x.rows())}};
      if (Afresh::is_on() || !evaluations().has(key_, Verb::linearize, request)) ++count;
    }
    workers_.announce(left.leftCols(count), announced_point_);
  }

  std::uint32_t take_point() {
    if (free_points_.empty()) return points_++;
    const std::uint32_t point = free_points_.back();
    free_points_.pop_back();
    return point;
  }
  void give_back(std::uint32_t point) { free_points_.push_back(point); }

  // CallsFailed where too many of this kind have failed in a row.
  void require_answers(Verb verb) const {
    const Index in_a_row = failures_.at(static_cast<std::size_t>(verb));
    if (in_a_row < failures_allowed_) return;
    throw CallsFailed(in_a_row == 1 ? last_failure_
                                    : fmt::format("{} calls in a row failed; the last: {}",
                                                  in_a_row, last_failure_));
  }

  static constexpr int kNowhere = -1;
  static std::string nothing(int) { return ""; }  // to prepare

 private:
  // A product needs a program that knows its point.
  bool has_own_products() const {
    const OracleSet& own = said().oracles;
    return own.contains(Oracle::pullback) || own.contains(Oracle::pushforward) ||
           own.contains(Oracle::jacobian);
  }
  void keep(Verb verb, Evaluations::Numbers request, std::span<const Real> answer,
            const std::string& why, double seconds, bool is_late, bool is_remembered) {
    const bool is_repeated = Afresh::is_on() && evaluations().has(key_, verb, request);
    if (!is_repeated)
      evaluations().keep(key_, verb, request, answer, why, seconds, is_late, is_remembered);
  }

  // Before it is taken, since this process may be killed first.
  void keep_announced(const Workers::Finished& call) {
    ++call_report().made;
    const std::array<std::span<const Real>, 2> request = {std::span<const Real>(), call.x};
    try {
      if (call.error) std::rethrow_exception(call.error);
      keep(Verb::linearize, request, call.y, "", call.seconds, false, false);
    } catch (const FailedCall& error) {
      const bool is_late = dynamic_cast<const LateProgram*>(&error) != nullptr;
      if (!is_late || ends_one_call_when_late())
        keep(Verb::linearize, request, {}, reason_of(error), call.seconds, is_late, false);
    } catch (const std::exception&) {  // no answer
      return;
    }
  }

  bool ends_one_call_when_late() const { return has_answered_ && has_call_time_; }
  static std::string reason_of(const FailedCall& error) {
    return error.reason.empty() ? "the program names no reason" : error.reason;
  }

  std::string answered(Verb verb, std::span<const Real> answer, const auto& ask) {
    try {
      ask();
      count_failure(verb, "", answer);
      has_answered_ = true;
      return "";
    } catch (const FailedCall& error) {
      is_late_ = dynamic_cast<const LateProgram*>(&error) != nullptr;
      if (is_late_ && !ends_one_call_when_late())
        throw LineError(fmt::format(
            "{}; process[…,call-time=SECONDS] sets another limit, and lets such calls fail where "
            "the program answers others",
            error.what()));
      count_failure(verb, error.what(), {});
      return reason_of(error);
    }
  }
  // `why`: empty where the program answered. A y that is not finite counts like any other failure.
  void count_failure(Verb verb, const std::string& why, std::span<const Real> answer) {
    if (failure_sink() != nullptr) failure_sink()->most_in_a_row = failures_allowed_;
    const auto is_finite = [](Real value) { return std::isfinite(value); };
    const bool has_value =
        why.empty() && (verb != Verb::linearize || std::ranges::all_of(answer, is_finite));
    Index& in_a_row = failures_.at(static_cast<std::size_t>(verb));
    in_a_row = has_value ? 0 : in_a_row + 1;
    last_failure_ = why.empty() ? kNotFinite : why;
  }

  bool has_several_, has_call_time_, has_answered_ = false;
  bool is_late_ = false;  // the last call
  Workers workers_;
  EvaluationKey key_;
  Index failures_allowed_;
  std::array<Index, static_cast<std::size_t>(Verb::x_error) + 1> failures_{};  // in a row, by verb
  std::string last_failure_;
  std::uint32_t points_ = 0;
  std::vector<std::uint32_t> free_points_;
  std::uint32_t announced_point_;
};

// Per workspace: the point of its products, and buffers for data that is not contiguous.
struct OwnPoint final : Scratch {
  ~OwnPoint() override {
    if (session) session->give_back(number);
  }
  std::shared_ptr<Session> session;
  std::uint32_t number = 0;
  int start = 0;            // of the program that knows the point; 0: the store answered
  bool has_failed = false;  // the forward pass
  Matrix in, out, within;
};

Vector vector_of(const std::vector<Real>& numbers) {
  return Eigen::Map<const Vector>(numbers.data(), static_cast<Index>(numbers.size()));
}

std::optional<Bounds> bounds_of(const ProblemHandshake& said) {
  if (said.lower.empty()) return std::nullopt;
  return Bounds{vector_of(said.lower), vector_of(said.upper), said.has_active_bounds};
}

std::span<const Real> numbers_of(const Matrix& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

class ProcessPhysics final : public ByJacobian {
 public:
  ProcessPhysics(std::shared_ptr<Session> session, const ProblemHandshake& said)
      : session_(std::move(session)),
        inputs_(said.inputs),
        outputs_(said.outputs),
        has_jacobian_(said.oracles.contains(Oracle::jacobian)),
        products_{.has_pushforward = said.oracles.contains(Oracle::pushforward) || has_jacobian_,
                  .has_pullback = said.oracles.contains(Oracle::pullback) || has_jacobian_,
                  .pushforward_price = said.pushforward_price,
                  .pullback_price = said.pullback_price,
                  .are_differences = said.are_differences},
        asks_pushforward_(said.oracles.contains(Oracle::pushforward)),
        asks_pullback_(said.oracles.contains(Oracle::pullback)),
        inverse_(inverse_of(said.inverse)),
        inverse_price_(said.inverse_price),
        bounds_(bounds_of(said)) {}

  Index inputs() const override { return inputs_; }
  Index outputs() const override { return outputs_; }
  Products products() const override { return products_; }
  bool is_elsewhere() const override { return true; }
  Inverse inverse_kind() const override { return inverse_; }
  Index inverse_price() const override { return inverse_price_; }

  // Outside the bounds P has no value; the program computes the nearest x inside.
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace& w) const override {
    OwnPoint& point = point_of(w);
    if (!bounds_) return ask(Verb::linearize, x, y, w);
    point.within.resize(x.rows(), x.cols());
    for (Index b = 0; b < x.cols(); ++b) point.within.col(b) = bounds_->nearest(x.col(b));
    ask(Verb::linearize, point.within, y, w);
    for (Index b = 0; b < x.cols(); ++b)
      if (!bounds_->hold(x.col(b))) y.col(b).setConstant(kNaN);
  }
  void begin_forwards(BatchRef x) const override {
    Matrix within = x;
    for (Index b = 0; bounds_ && b < x.cols(); ++b) within.col(b) = bounds_->nearest(x.col(b));
    session_->announce(within);
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    asks_pushforward_ ? ask(Verb::pushforward, v, Jv, w) : ByJacobian::pushforward(v, Jv, w);
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    asks_pullback_ ? ask(Verb::pullback, u, JTu, w) : ByJacobian::pullback(u, JTu, w);
  }
  void jacobian(BatchOut J, Workspace& w) const override {
    has_jacobian_ ? ByJacobian::jacobian(J, w) : Physics::jacobian(J, w);
  }

  Success local_inverse(BatchRef y, BatchRef x0, BatchRef, BatchOut x) const override {
    const Matrix targets = y, starts = x0;  // each in one piece
    Vector answer(x.size() + y.cols());     // x, then one success flag per sample
    const std::array<std::span<const Real>, 2> given = {numbers_of(targets), numbers_of(starts)};
    const std::span<Real> numbers(answer.data(), static_cast<std::size_t>(answer.size()));
    const std::string why =
        session_->call(Verb::inverse, 0, given, given, numbers, Session::nothing);
    session_->require_answers(Verb::inverse);
    if (!why.empty()) return Success::Constant(y.cols(), false);
    x = answer.head(x.size()).reshaped(x.rows(), x.cols());
    return answer.tail(y.cols()).array() == 1;
  }

 private:
  OwnPoint& point_of(Workspace& w) const {
    OwnPoint& point = w.as<OwnPoint>();
    if (!point.session) {
      point.session = session_;
      point.number = session_->take_point();
    }
    return point;
  }

  // Straight from the caller's arrays and into them, where each lies in one piece.
  void ask(Verb verb, BatchRef given, BatchOut answer, Workspace& w) const {
    OwnPoint& point = point_of(w);
    const bool is_forward = verb == Verb::linearize;
    if (!is_forward && point.has_failed) {
      answer.setConstant(kNaN);
      return;
    }
    const bool is_whole = given.outerStride() == given.rows();
    if (!is_whole) point.in = given;
    const Real* const from = is_whole ? given.data() : point.in.data();
    const std::span<const Real> numbers(from, static_cast<std::size_t>(given.size()));
    const auto count = static_cast<std::size_t>(answer.size());
    const bool is_direct = answer.outerStride() == answer.rows();
    if (!is_direct) point.out.resize(answer.rows(), answer.cols());
    Real* const to = is_direct ? answer.data() : point.out.data();
    if (is_forward) point.start = 0;
    const auto prepare = [&](int start) {
      if (!is_forward) return remember(point, w);
      point.start = start;
      return std::string();
    };
    const std::span<const Real> x = is_forward ? std::span<const Real>() : point_x(point, w);
    const std::string why = session_->call(verb, point.number, numbers, {to, count}, prepare, x);
    if (is_forward) point.has_failed = !why.empty();
    if (!why.empty()) {
      add_failure(numbers_of(bounds_ ? point.within : w.x),
                  is_forward ? why : fmt::format("{}: {}", name_of(verb), why));
      answer.setConstant(kNaN);
    } else {
      if (!is_direct) answer = point.out;
      if (is_forward && !answer.allFinite())
        add_failure(numbers_of(bounds_ ? point.within : w.x), kNotFinite);
    }
    session_->require_answers(verb);
  }

  std::span<const Real> point_x(const OwnPoint& point, const Workspace& w) const {
    return numbers_of(bounds_ ? point.within : w.x);
  }

  // The forward pass again, in a program that was started since. Why it failed, else empty.
  std::string remember(OwnPoint& point, const Workspace& w) const {
    if (point.start == session_->starts()) return "";
    const std::span<const Real> x = point_x(point, w);
    Vector y(outputs_ * w.x.cols());
    const int start = session_->starts();
    std::string why = session_->ask_program(Verb::linearize, point.number, std::span(&x, 1),
                                            {y.data(), static_cast<std::size_t>(y.size())});
    if (why.empty()) point.start = start;
    return why;
  }

  void form_jacobian(Matrix& J, Workspace& w) const override {
    ask(Verb::jacobian, Matrix(0, 0), J, w);
  }

  std::shared_ptr<Session> session_;
  Index inputs_, outputs_;
  bool has_jacobian_;
  Products products_;
  bool asks_pushforward_, asks_pullback_;
  Inverse inverse_;
  Index inverse_price_;
  std::optional<Bounds> bounds_;
};

ProblemParts process_parts(const ProblemHandshake& said, const std::shared_ptr<Session>& session,
                           const Draw& draw) {
  const Vector standard = vector_of(said.start);
  const StartScale scale = said.has_own_scale ? StartScale::own : StartScale::at_least_one;
  ProblemParts parts{.physics = std::make_unique<ProcessPhysics>(session, said),
                     .start = draw.start(standard, scale),
                     .start_scale = scale,
                     .target = vector_of(said.target),
                     .aim = said.aim,
                     .minimum = said.minimum};
  if (!said.drawn.empty()) parts.start = Start(vector_of(said.drawn), standard);
  parts.names = said.names;
  parts.units = said.units;
  parts.bounds = bounds_of(said);  // a sampled start outside of them is moved to the nearest point
  if (said.x_floor > 0) parts.x_floor = [floor = said.x_floor](const Batch&) { return floor; };
  if (said.has_x_error)
    parts.x_error = [session](BatchRef x, const Batch&) {
      const Matrix whole = x;  // in one piece
      Real error = 0;
      const std::span<const Real> numbers = numbers_of(whole);
      const std::string why =
          session->call(Verb::x_error, 0, numbers, std::span(&error, 1), Session::nothing);
      session->require_answers(Verb::x_error);
      return why.empty() ? error : kNaN;
    };
  if (!said.truth.empty()) parts.truth = vector_of(said.truth);
  const bool has_products = said.oracles.contains(Oracle::pushforward) ||
                            said.oracles.contains(Oracle::pullback) ||
                            said.oracles.contains(Oracle::jacobian);
  if (said.are_differences && !has_products) replace_derivatives(parts, "central", true, "");
  return parts;
}

Problem make_process(const OptionValues& options, const Draw& draw) {
  const auto given = read_options<SimulatorOptions>(options);
  const OptionValues declared = declared_values(options);
  const auto session = std::make_shared<Session>(given, draw.instance_seed(), declared);
  ProblemHandshake said = session->said();
  if (!said.drawn.empty() && draw.start_seed() != draw.instance_seed()) {  // it samples its starts
    said.drawn = Session(given, draw.start_seed(), declared).said().drawn;
  }
  return Problem(process_parts(said, session, draw));
}

Foreign introduce(const OptionValues& options) {
  static Introductions<ProblemHandshake> all;
  const auto given = read_options<SimulatorOptions>(options);
  const OptionValues declared = declared_values(options);
  Foreign foreign =
      all.of(given.command, declared,
             [&](Line& line) { return greet_problem(line, 0, given.startup, declared); })
          .foreign;
  if (!given.label.empty()) foreign.label = given.label;
  return foreign;
}

}  // namespace

void register_process(ProblemRegistry& registry) {
  registry.add({.name = "process",
                .title = "A problem that another program computes",
                .formula = "y = P(x) and its products, by frames over a private socket",
                .source = "see the record",
                .options = option_table<SimulatorOptions>(),
                .in_all = false,
                .needs_argument = "process[command=…]",
                .introduce = introduce,
                .make = make_process});
}

}  // namespace isoline::problems
