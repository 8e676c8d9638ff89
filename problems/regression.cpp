// A network learns a function from samples of it, the regressions on which the authors of Sven,
// singular value descent, compare optimizers: arXiv 2604.01279, and their repository of
// experiments.
//
//   L = 1/B Σ (N(t; θ) − y*(t))²,  y* = (f − mean f)/(standard deviation of f)
//   bump        f(t) = exp(−10 t²) sin 2t,  t uniform in [−1, 1]
//   polynomial  f(t) = Σ cₘ m(t)/rms(m) over the 210 monomials m of degree 4 or less of
//               6 variables, t and c normal, rms(m)² = E m² = Π (2pⱼ − 1)!! for the powers pⱼ
//
// N is a perceptron of three layers of 16 gelu neurons in single precision, with PyTorch's start;
// batches of 32 are consecutive slices of a fixed set of 313 batches, 20 times. Deviations: the
// set has 10,016 samples instead of 10,000, its order is the same in every epoch, and each seed
// has another set and polynomial. As there, half-inverse gradients add the gradients of a batch,
// which L averages: their rate η is 32 η here.
#include <array>
#include <cmath>

#include "problems/dense_physics.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

struct Regression {
  std::string function = "bump";
  Learning learning{
      .mode = "learn", .network = "mlp[layers=16-16-16,activation=gelu]", .batch = 32};
};
void fields(Regression& o, auto& field) {
  field("function", o.function, {"bump", "polynomial"},
        "f: exp(−10 t²) sin 2t, or a random polynomial of degree 4 in 6 variables");
  fields(o.learning, field);
}

constexpr Index kBatches = 313, kVariables = 6, kDegree = 4;

class Unchanged final : public DensePhysics {  // y = x
 public:
  Unchanged() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y = x; }
  void derivative(VectorRef, BatchOut J) const override { J(0, 0) = 1; }
  bool has_curvature() const override { return true; }
  void second(VectorRef, VectorRef, BatchOut) const override {}
  Inverse inverse_kind() const override { return Inverse::exact; }
  bool invert(VectorRef y, VectorRef, VectorOut x) const override {
    x = y;
    return true;
  }
};

Real bump(VectorRef t) { return std::exp(-10 * t[0] * t[0]) * std::sin(2 * t[0]); }

class Polynomial {
 public:
  explicit Polynomial(RandomStream stream) : stream_(std::move(stream)) { add(0, 0, 1); }
  Real operator()(VectorRef t) const {
    Real sum = 0;
    for (const Term& term : terms_) {
      Real m = term.coefficient;
      for (Index j = 0; j < kVariables; ++j)
        for (int p = 0; p < term.powers[static_cast<std::size_t>(j)]; ++p) m *= t[j];
      sum += m;
    }
    return sum;
  }

 private:
  struct Term {
    std::array<int, kVariables> powers;
    Real coefficient;
  };
  // All powers of the variables from the j-th on whose sum leaves the degree.
  void add(std::size_t j, int degree, Real mean_square) {
    if (j == powers_.size()) {
      terms_.push_back({powers_, stream_.normal_vector(1)[0] / std::sqrt(mean_square)});
      return;
    }
    for (int p = 0; degree + p <= kDegree; ++p) {
      powers_[j] = p;
      add(j + 1, degree + p, mean_square);
      mean_square *= 2 * p + 1;  // E t^(2p + 2) = (2p + 1) E t^(2p)
    }
  }
  RandomStream stream_;
  std::array<int, kVariables> powers_ = {};
  std::vector<Term> terms_;
};

using Function = std::function<Real(VectorRef t)>;

// f less its mean over its standard deviation, both of so many samples.
Function normalized(Function f, const std::function<Vector(RandomStream&)>& draw,
                    RandomStream stream) {
  constexpr Index kSamples = 10000;
  Vector values(kSamples);
  for (Real& value : values) value = f(draw(stream));
  const Real mean = values.mean();
  const Real deviation = std::sqrt((values.array() - mean).square().mean());
  return [f = std::move(f), mean, deviation](VectorRef t) { return (f(t) - mean) / deviation; };
}

ProblemParts make_regression(const Regression& o, const Draw& draw) {
  require(o.learning.is_on(), "regression has only mode=learn; remove mode=direct");
  const bool is_bump = o.function == "bump";
  const std::function<Vector(RandomStream&)> point = [is_bump](RandomStream& stream) {
    return is_bump ? stream.uniform_vector(1, -1, 1) : stream.normal_vector(kVariables);
  };
  const Function f = normalized(is_bump ? Function(bump) : Polynomial(draw.stream("polynomial")),
                                point, draw.stream("scale"));
  const auto sample = [f, point](RandomStream& stream, Index b, Batch& batch) {
    batch.input.col(b) = point(stream);
    batch.target(0, b) = batch.truth(0, b) = f(batch.input.col(b));
  };
  const auto distance = [](BatchRef x, const Batch& batch) {
    return (x - batch.truth).norm() / std::sqrt(static_cast<Real>(x.cols()));
  };
  return learn(o.learning, {.inputs = is_bump ? 1 : kVariables, .outputs = 1}, draw,
               {.physics = std::make_unique<Unchanged>(),
                .loss = std::make_unique<HalfSquared>(2),
                .minimum = 0,
                .x_error = distance,
                .x_scale = 1,
                .samples = {.epoch = kBatches * o.learning.batch, .draw = sample}});
}

}  // namespace

void register_regression(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "regression",
       .title = "A function learned by a network",
       .group = Group::toy,
       .formula = "L = 1/B Σ (N(t; θ) − y*(t))²",
       .source = "Bright-Thonney, Harvey, Lukas, Thaler (2026), arXiv 2604.01279, and their "
                 "repository of experiments",
       .note = "Physics is the identity, so that only the network is optimized. The error in x is "
               "the root of the mean squared error over the validation. An epoch has 313 batches.",
       .aim = Aim::loss,
       .in_all = false,
       .panels = {{.title = "Mean squared error", .kind = "curve"}}},
      make_regression));
}

}  // namespace isoline::problems
