// An optimizer in another program: process[command="python3 mine.py"]. The program calls the
// oracles over frames on a private socket (docs/serving-problems.md), and the meter counts them.
// Oracles that its handshake did not declare are refused. Calls at the same θ share one forward.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <unordered_map>

#include "core/foreign/handshake.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

constexpr auto kDone = static_cast<std::uint32_t>(Answer::done);
constexpr auto kStop = static_cast<std::uint32_t>(Answer::stop);

std::span<const Real> numbers_of(const auto& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

// One run: questions answered until the other has finished or the harness has.
class Service {
 public:
  Service(Meter& f, Line& line, const MethodHandshake& said, Vector& theta)
      : f_(f),
        line_(line),
        said_(said),
        bounds_(said.keeps_bounds ? f.bounds() : nullptr),
        theta_(theta),
        room_(std::max({2 * f.unknowns(), f.unknowns() + f.residuals(), kLeastRoom})),
        scale_(1 / std::sqrt(static_cast<Real>(f.samples()))) {}

  Status run() {
    for (;;) {
      const FrameHead head = line_.receive({room_.data(), static_cast<std::size_t>(room_.size())});
      const auto verb = static_cast<Verb>(head.verb);
      if (verb == Verb::claim) {
        take_claim(head);
        continue;
      }
      if (verb != Verb::finish && is_over()) {
        open_ = verb;
        break;
      }
      try {
        if (verb == Verb::finish) return finish(head);
        answer(verb, head);
      } catch (const BudgetSpent&) {
        open_ = verb;
        return Status::budget;
      } catch (const std::exception& error) {
        line_.send_text(verb, static_cast<std::uint32_t>(Answer::failed), error.what());
        throw;
      }
    }
    if (is_of_one_x()) {
      f_.remark(InARow::kOfOneX);
      return Status::stalled;
    }
    return f_.status() == Status::running ? Status::budget : f_.status();
  }

  std::optional<Verb> open() const { return open_; }

 private:
  static constexpr Index kLeastRoom = 512;  // numbers, for the text of a claim

  bool is_of_one_x() const { return repeats_ >= InARow::kMostRepeats; }
  bool is_over() const { return is_of_one_x() || f_.is_spent() || f_.status() != Status::running; }

  void expect(const FrameHead& head, Index numbers) {
    if (head.bytes == static_cast<std::uint64_t>(numbers) * sizeof(Real)) return;
    line_.fail("sent a request " + std::string(name_of(static_cast<Verb>(head.verb))) + " of " +
               std::to_string(head.bytes) + " bytes, which must have " +
               std::to_string(static_cast<std::size_t>(numbers) * sizeof(Real)) + " bytes");
  }
  Eigen::Map<const Vector> given_theta() const {
    for (Index i = 0; bounds_ && i < f_.unknowns(); ++i) {
      const Real low = bounds_->lower[i], high = bounds_->upper[i];
      require(!(room_[i] < low || room_[i] > high), [&] {
        return fmt::format(
            "{} declares keeps_bounds, but component {} of θ is {}, outside its bounds [{}, {}]",
            line_.sender(), i, room_[i], low, high);
      });
    }
    return {room_.data(), f_.unknowns()};
  }
  static std::size_t hash_of(const Vector& theta) {
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(theta.data()),
                                          sizeof(Real) * static_cast<std::size_t>(theta.size())});
  }
  // A point that the program has evaluated is not charged for again where it is judged.
  void take_theta() {
    theta_ = given_theta();
    if (const auto known = paid_.find(hash_of(theta_)); known != paid_.end())
      f_.recall_paid_loss(known->second);
  }
  auto behind_theta(Index count) const { return room_.segment(f_.unknowns(), count); }
  void reply(Verb verb, std::span<const Real> numbers) { line_.send(verb, kDone, numbers); }

  // One forward per point, for all calls there; products with other vectors repeat nothing.
  Linearization& at_given(bool is_product = false) {
    const bool is_same = point_theta_.size() > 0 &&
                         std::memcmp(point_theta_.data(), room_.data(),
                                     sizeof(Real) * static_cast<std::size_t>(f_.unknowns())) == 0;
    repeats_ = is_same && !is_product ? repeats_ + 1 : 0;
    if (is_same) return point_;
    point_theta_ = given_theta();
    f_.linearize(point_theta_, point_);
    paid_[hash_of(point_theta_)] = f_.paid_loss();
    if (!said_.reports && point_.loss() < best_loss_) {  // what is better counts as an iteration
      best_loss_ = point_.loss();
      theta_ = point_theta_;
      f_.iterate(theta_);
    }
    return point_;
  }

  void answer(Verb verb, const FrameHead& head) {
    const Index n = f_.unknowns();
    switch (verb) {
      case Verb::value:
      case Verb::gradient:
      case Verb::value_and_gradient:
        expect(head, n);
        return answer_loss(verb);
      case Verb::residual:
      case Verb::jacobian_of_r:
        expect(head, n);
        return answer_residual(verb);
      case Verb::pushforward_of_r:
      case Verb::hessian_product:
        expect(head, 2 * n);
        return answer_along(verb);
      case Verb::pullback_of_r:
        expect(head, n + f_.residuals());
        return answer_pullback();
      case Verb::report:
        expect(head, n);
        take_theta();
        f_.iterate(theta_);
        return reply(verb, {});
      default:
        line_.fail("sent verb " + std::to_string(head.verb) + ", which is not a request");
    }
  }

  void answer_loss(Verb verb) {
    Linearization& at = at_given();
    const Real loss = at.loss();
    if (verb == Verb::value) return reply(verb, {&loss, 1});
    at.gradient(gradient_);
    if (verb == Verb::gradient) return reply(verb, numbers_of(gradient_));
    const std::array<std::span<const Real>, 2> both = {std::span(&loss, 1), numbers_of(gradient_)};
    line_.send(verb, kDone, both);
  }
  void answer_residual(Verb verb) {
    Linearization& at = at_given();
    if (verb == Verb::residual) {
      at.residual(residual_);
      return reply(verb, numbers_of(residual_));
    }
    if (f_.samples() == 1) return reply(verb, numbers_of(at.jacobian()));
    scaled_ = scale_ * at.jacobian();
    reply(verb, numbers_of(scaled_));
  }
  void answer_along(Verb verb) {
    const Vector v = behind_theta(f_.unknowns());
    Linearization& at = at_given(true);
    if (verb == Verb::hessian_product) {
      gradient_.resize(f_.unknowns());
      at.hessian_product(v, gradient_);
      return reply(verb, numbers_of(gradient_));
    }
    scaled_.resize(f_.residuals() / f_.samples(), f_.samples());
    at.pushforward(v, scaled_);
    scaled_ *= scale_;
    reply(verb, numbers_of(scaled_));
  }
  void answer_pullback() {
    const Index samples = f_.samples(), outputs = f_.residuals() / samples;
    const Matrix w = scale_ * behind_theta(f_.residuals()).reshaped(outputs, samples);
    Linearization& at = at_given(true);
    gradient_.resize(f_.unknowns());
    at.pullback(w, gradient_);
    reply(Verb::pullback_of_r, numbers_of(gradient_));
  }

  void take_claim(const FrameHead& head) {
    f_.claim({reinterpret_cast<const char*>(room_.data()), head.bytes});
    reply(Verb::claim, {});
  }
  Status finish(const FrameHead& head) {
    expect(head, f_.unknowns());
    take_theta();
    reply(Verb::finish, {});
    return Status::converged;
  }

  Meter& f_;
  Line& line_;
  const MethodHandshake& said_;
  const Bounds* const bounds_;
  Vector& theta_;
  Vector room_;  // the last question
  Real scale_;
  Vector point_theta_;  // (n), where `point_` is; empty: nowhere yet
  Linearization point_;
  int repeats_ = 0;                             // evaluations at `point_`, in a row
  std::unordered_map<std::size_t, Real> paid_;  // losses, by the bits of θ
  Real best_loss_ = std::numeric_limits<Real>::infinity();
  Vector gradient_, residual_;
  Matrix scaled_;
  std::optional<Verb> open_;  // the question that came when the run was over
};

class ProcessMethod final : public Optimizer {
 public:
  ProcessMethod(const ProcessOptions& given, const OptionValues& declared)
      : line_(door_to(given.command)), said_(greet_method(line_, given.startup, declared)) {}
  ~ProcessMethod() override {
    if (has_begun_) end();
  }
  bool reports_iterations() const override { return true; }
  void start(Meter& f, const Vector& theta) override {
    const std::array<Real, 2> sizes = {static_cast<Real>(f.unknowns()),
                                       static_cast<Real>(f.residuals())};
    const Bounds* const bounds = said_.keeps_bounds ? f.bounds() : nullptr;
    std::vector<std::span<const Real>> told = {sizes, numbers_of(theta)};
    if (bounds != nullptr)
      told.insert(told.end(), {numbers_of(bounds->lower), numbers_of(bounds->upper)});
    has_begun_ = true;
    line_.send(Verb::begin, 0, told);
  }
  Status step(Meter& f, Vector& theta) override {
    Service service(f, line_, said_, theta);
    const Status verdict = service.run();
    open_ = service.open();
    return verdict;
  }

 private:
  // Off the clock. Every further request gets the status stop: most programs exit then; one that
  // continues is killed.
  void end() {
    constexpr int kMost = 100;
    constexpr double kSeconds = 1;
    std::array<Real, 1> room{};
    try {
      if (open_) line_.send(*open_, kStop, std::span<const Real>());
      for (int i = 0; i < kMost; ++i)
        line_.send(static_cast<Verb>(line_.receive(room, kSeconds).verb), kStop,
                   std::span<const Real>());
    } catch (const std::exception&) {  // it has left, or says nothing any more
    }
  }

  Line line_;
  MethodHandshake said_;
  bool has_begun_ = false;
  std::optional<Verb> open_;  // a request without an answer
};

const MethodHandshake& introduced(const OptionValues& options) {
  static Introductions<MethodHandshake> all;
  const auto given = read_options<ProcessOptions>(options);
  const OptionValues declared = declared_values(options);
  return all.of(given.command, declared,
                [&](Line& line) { return greet_method(line, given.startup, declared); });
}

Foreign introduce(const OptionValues& options) {
  Foreign foreign = introduced(options).foreign;
  if (const std::string label = options.text("label"); !label.empty()) foreign.label = label;
  return foreign;
}

std::string objection(const OptionValues& options, const Problem& problem) {
  const MethodHandshake& said = introduced(options);
  if (said.is_least_squares && !problem.is_least_squares())
    return "the loss is not a multiple of ‖y − y*‖², which least squares minimizes";
  const bool has_bounds = problem.bounds() && problem.bounds()->are_needed;
  if (has_bounds && !said.keeps_bounds)
    return "the problem has bounds on x, and this program does not declare keeps_bounds";
  return "";
}

}  // namespace

void register_process(OptimizerRegistry& registry) {
  registry.add({.name = "process",
                .title = "An optimizer that another program runs",
                .family = Family::foreign,
                .formula = "θ as the program chooses it, from the oracles that it calls",
                .source = "see the record",
                .needs = {Oracle::forward},
                .needs_same_samples = true,
                .keeps_bounds = true,  // or its handshake says otherwise: an objection
                .options = option_table<ProcessOptions>(),
                .in_all = false,
                .needs_argument = "process[command=…]",
                .introduce = introduce,
                .needs_for = [](const OptionValues& options,
                                const Problem&) { return introduced(options).needs; },
                .objection = objection,
                .make = [](const OptionValues& options,
                           const OptimizerRegistry&) -> std::unique_ptr<Optimizer> {
                  return std::make_unique<ProcessMethod>(read_options<ProcessOptions>(options),
                                                         declared_values(options));
                }});
}

}  // namespace isoline::optimizers
