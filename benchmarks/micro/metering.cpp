// The overhead of counting and tracing in an evaluation of a tiny problem.
#include "benchmarks/micro/pairs.h"

namespace isoline::benchmarks::micro {

using optimizers::Linearization;
namespace {

constexpr int kCalls = 1000, kPairs = 401;

Budget with_clock() {
  Budget budget = endless();
  budget.seconds = 1e6;
  return budget;
}

// A metered problem beside what the bare call needs.
struct Metered {
  explicit Metered(const Budget& budget)
      : problem(make_problem("scaling")),
        meter(problem, budget, {Oracle::forward}, trace),
        theta(problem.start()) {
    meter.begin(theta);
    for (int i = 0; i < kCalls * kCalls; ++i) meter.iterate(theta);  // past the dense curve
  }

  const Problem problem;
  Trace trace;
  Meter meter;
  Vector theta;
  Linearization at;
  Point point;
  std::uint64_t seen = 0;
};

// A little better each time, or the run would have stalled.
void approach(Metered& f) { f.theta *= 1 - 1e-9; }

using Call = void (*)(Metered& f);

void bare(Metered& f) { f.problem.forward(f.theta, f.point); }

void add(const std::string& name, const Budget& budget, const Goal& goal, Call ours) {
  register_pair("metering/" + name, kPairs, goal, [=] {
    const auto f = std::make_shared<Metered>(budget);
    const auto timed = [f](Call call) {
      return [=] {
        return cost_of(kCalls, [&] {
          approach(*f);
          call(*f);
        });
      };
    };
    return Pair{timed(ours), timed(bare)};
  });
}

}  // namespace

void register_metering() {
  const Goal without_clock{.extra_ns = 5}, with_counter{.extra_ns = 15};
  add("loss", endless(), without_clock, [](Metered& f) { f.meter.loss(f.theta); });
  add("linearize", endless(), without_clock, [](Metered& f) { f.meter.linearize(f.theta, f.at); });
  add("loss-clock", with_clock(), with_counter, [](Metered& f) {
    f.meter.loss(f.theta);
    f.meter.is_spent();
  });
  add("bare-counter", endless(), {}, [](Metered& f) {  // what is_spent() cannot go below
    f.problem.forward(f.theta, f.point);
    f.seen += ticks();
  });
}

}  // namespace isoline::benchmarks::micro
