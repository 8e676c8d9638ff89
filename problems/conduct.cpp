// Small inputs with known answers, on which `isoline audit --conduct` measures what the counts, the
// statuses, the returned points and the bounds of a method mean. docs/conduct.md lists them; the
// same inputs measure libraries without Isoline. A problem counts its own calls, as a user's
// simulator would, and states them as quantities of the run.
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "core/failures.h"
#include "problems/jet_physics.h"
#include "problems/more_garbow_hillstrom.h"

namespace isoline::problems {
namespace {

struct Options {
  std::string input = "line";
  bool scales_unknowns = true;
};
void fields(Options& o, auto& field) {
  field("input", o.input,
        Choices{"line", "decay", "decay-scaled", "decay-small", "decay-bounded", "valley",
                "valley-bounded", "solved", "missing"},
        "line: (a + b t)/0.1; decay: a exp(−b t) + c; decay-scaled: with b in units of 1e-6; "
        "decay-small: the loss times 1e-3; decay-bounded: within ±1e6; valley: Rosenbrock's; "
        "valley-bounded: with x1 ≤ 0.5; solved: √i (xᵢ − 1) from its solution; missing: "
        "(ln p, (p − 1)/10), without a value for p ≤ 0");
  field(
      "scale-unknowns", o.scales_unknowns,
      "methods see each unknown divided by its size at the start, as those of a program of users");
}

// The calls of a run. A second look of the harness at a known point is no call of the method: it
// reports each look of its own, right after the call that it took.
class Calls {
 public:
  explicit Calls(std::optional<Bounds> bounds) : bounds_(std::move(bounds)) {}

  void add(VectorRef x) {
    last_.assign(reinterpret_cast<const char*>(x.data()), sizeof(Real) * x.size());
    // One call where a method asks twice in a row, or goes on where the harness has looked.
    is_counted_ = last_ != looked_ && last_ != asked_;
    before_ = std::exchange(asked_, last_);
    looked_.clear();
    is_new_ = seen_.insert(last_).second;
    has_called_ = true;
    if (is_counted_) ++made_;
    if (!bounds_) return;
    const Real by = std::max((bounds_->lower - x).maxCoeff(), (x - bounds_->upper).maxCoeff());
    if (by > 0) ++outside_;
    farthest_ = std::max(farthest_, by);
  }
  // The first look, at the start, is free, as are the calls before it, for the scales of unknowns.
  void look(VectorOut values) {
    asked_ = before_;
    if (std::exchange(is_start_, false)) {
      made_ = outside_ = 0;
      farthest_ = 0;
    } else if (has_called_) {
      if (is_counted_ && !is_new_) --made_;
      if (is_new_ || !is_counted_) looked_ = last_;
    }
    has_called_ = false;
    values << static_cast<Real>(made_), static_cast<Real>(outside_), farthest_;
  }

 private:
  std::optional<Bounds> bounds_;
  std::set<std::string> seen_;  // x by its bits
  std::string last_, looked_, asked_, before_;
  bool is_counted_ = false, is_new_ = false, has_called_ = false, is_start_ = true;
  std::int64_t made_ = 0, outside_ = 0;
  Real farthest_ = 0;
};

template <class F>
class Counted final : public JetPhysics<F> {
 public:
  Counted(F f, Index n, Index m, std::shared_ptr<Calls> calls)
      : JetPhysics<F>(std::move(f), n, m), calls_(std::move(calls)) {}
  void value(VectorRef x, VectorOut y) const override {
    JetPhysics<F>::value(x, y);
    calls_->add(x);
    if (!y.allFinite()) add_failure({x.data(), static_cast<std::size_t>(x.size())}, "no value");
  }

 private:
  std::shared_ptr<Calls> calls_;
};

struct Decay {
  Real unit = 1, size = 1;
  template <class Scalar>
  void operator()(const Scalar* x, int, Scalar* y, int m) const {
    for (int i = 0; i < m; ++i) y[i] = size * (x[0] * exp(-(unit * 0.25 * i) * x[1]) + x[2]);
  }
};

constexpr Real kSigma = 0.1;  // of the line
constexpr JetFunction kLine = jet_function([](auto x, int, auto y, int m) {
  for (int i = 0; i < m; ++i) y[i] = (x[0] + static_cast<Real>(i) * x[1]) / kSigma;
});
constexpr JetFunction kSolved = jet_function([](auto x, int, auto y, int m) {
  for (int i = 0; i < m; ++i) y[i] = std::sqrt(i + 1.0) * (x[i] - 1.0);
});
constexpr JetFunction kMissing = jet_function([](auto x, int, auto y, int) {
  y[0] = log(x[0]);
  y[1] = 0.1 * (x[0] - 1.0);
});

ProblemParts make_conduct(const Options& o, const Draw&) {
  ProblemParts parts;
  parts.start_scale = o.scales_unknowns ? StartScale::own : StartScale::at_least_one;
  if (o.input == "valley-bounded")
    parts.bounds = Bounds{Eigen::Vector2d(-2, -2), Eigen::Vector2d(0.5, 2)};
  if (o.input == "decay-bounded")
    parts.bounds = Bounds{Vector::Constant(3, -1e6), Vector::Constant(3, 1e6)};
  const auto calls = std::make_shared<Calls>(parts.bounds);
  parts.series = {.names = {"calls", "outside", "farthest outside"},
                  .evaluate = [calls](const Problem&, VectorRef, Point&, VectorOut values) {
                    calls->look(values);
                  }};
  const auto set = [&](auto f, const Vector& start, const Vector& target) {
    parts.physics = std::make_unique<Counted<decltype(f)>>(f, start.size(), target.size(), calls);
    parts.start = start;
    parts.target = target;
  };
  if (o.input == "line") {
    constexpr std::array<Real, 10> kDeviations = {0.3, -1.1, 0.8,  0.1, -0.6,
                                                  1.4, -0.2, -0.9, 0.5, -0.3};
    Vector target(10);
    for (Index i = 0; i < 10; ++i)
      target[i] =
          (1 + 2 * static_cast<Real>(i)) / kSigma + kDeviations[static_cast<std::size_t>(i)];
    set(kLine, Vector::Zero(2), target);
  } else if (o.input.starts_with("decay")) {
    constexpr Index kTimes = 21;
    const Decay decay{o.input == "decay-scaled" ? 1e-6 : 1,
                      o.input == "decay-small" ? std::sqrt(1e-3) : 1};
    Vector target(kTimes);
    for (Index i = 0; i < kTimes; ++i) {
      const Real t = 0.25 * static_cast<Real>(i);
      target[i] =
          decay.size * (2.5 * std::exp(-0.7 * t) + 0.5 + 0.05 * std::sin(7 * static_cast<Real>(i)));
    }
    set(decay, Eigen::Vector3d(1, 1 / decay.unit, 0), target);
  } else if (o.input.starts_with("valley")) {
    set(kRosenbrock, Eigen::Vector2d(-1.2, 1), Vector::Zero(2));
  } else if (o.input == "solved") {
    set(kSolved, Vector::Ones(3), Vector::Zero(3));
  } else {
    set(kMissing, Vector::Constant(1, 10), Vector::Zero(2));
  }
  return parts;
}

}  // namespace

void register_conduct(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "conduct",
       .title = "Small inputs to watch a method",
       .group = Group::toy,
       .formula = "P(x) by the option input,  L = ½‖P(x) − y*‖²",
       .source = "Isoline, docs/conduct.md",
       .note = "Its quantities are its own calls, those outside the bounds, and how far outside.",
       .in_all = false},
      make_conduct));
}

}  // namespace isoline::problems
