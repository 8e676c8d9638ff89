// P(x) = eˣ, component by component: targets that span orders of magnitude. Holl, Koltun, Thuerey
// (2022), Fig. 2, learns the inverse over x* = −12u, u ~ U[0, 1). The direct problem finds one x*
// of this distribution from x = 0. Seed 0 has its quantiles x*ᵢ = −12 (i + ½)/n, so y* = e⁻⁶ for n
// = 1.
#include <algorithm>
#include <array>
#include <cmath>

#include "problems/learning.h"
#include "problems/physics.h"

namespace isoline::problems {
namespace {

struct Options {
  Index n = 1;
  Learning learning{.network = "mlp[layers=16-64-16,activation=sigmoid]", .batch = 100};
};
void fields(Options& o, auto& field) {
  field("n", o.n, between(1, 1e6), "number of components");
  fields(o.learning, field);
}

// The scalar function: a vectorized one would give an entry other bits by its place in the array.
constexpr auto kExp = [](Real x) { return std::exp(x); };

class Exponential final : public Physics {
 public:
  explicit Exponential(Index n) : n_(n) {}
  Index inputs() const override { return n_; }
  Index outputs() const override { return n_; }

  void forward(BatchRef x, BatchRef, BatchOut y, Workspace& w) const override {
    y = x.unaryExpr(kExp);
    w.saved.resize(1);
    w.saved[0] = y;  // P is its own derivative
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Jv = w.saved[0].cwiseProduct(v);
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override { pushforward(u, JTu, w); }
  bool has_curvature() const override { return true; }
  void curvature(BatchRef u, BatchOut out, Workspace& w) const override {
    out.setZero();
    for (Index b = 0; b < u.cols(); ++b)
      out.middleCols(b * n_, n_).diagonal() = w.saved[0].col(b).cwiseProduct(u.col(b));
  }
  void curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const override {
    out = w.saved[0].cwiseProduct(u).cwiseProduct(v);
  }

  Inverse inverse_kind() const override { return Inverse::exact; }
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef, BatchOut x) const override {
    x = y.binaryExpr(x0, [](Real yi, Real guess) { return yi > 0 ? std::log(yi) : guess; });
    return (y.array() > 0).colwise().all().transpose();
  }

 private:
  Index n_;
};

constexpr Real kSpan = -12;  // y* falls to e⁻¹²

constexpr std::array kDecades = {
    "error in x, y* from 0.1 to 1",     "error in x, y* from 1e-2 to 1e-1",
    "error in x, y* from 1e-3 to 1e-2", "error in x, y* from 1e-4 to 1e-3",
    "error in x, y* from 1e-5 to 1e-4", "error in x, y* below 1e-5"};

// Mean |x − x*| by decade of y*; not-a-number where a decade has no sample.
void errors_by_decade(const Problem&, VectorRef, Point& at, VectorOut values) {
  const auto last = static_cast<Index>(kDecades.size()) - 1;
  Vector counts = Vector::Zero(last + 1);
  values.setZero();
  for (Index i = 0; i < at.x().size(); ++i) {
    const Real target = at.batch->target.reshaped()[i];
    const Index decade = std::clamp<Index>(static_cast<Index>(-std::log10(target)), 0, last);
    values[decade] += std::abs(at.x().reshaped()[i] - at.batch->truth.reshaped()[i]);
    ++counts[decade];
  }
  values.array() /= counts.array();
}

// x* = −12u, u ~ U[0, 1); the network sees y* as it is.
ProblemParts learn_exponential(const Options& o, const Draw& draw) {
  const auto sample = [](RandomStream& stream, Index b, Batch& batch) {
    for (Real& x : batch.truth.col(b)) x = kSpan * stream.uniform();
    batch.target.col(b) = batch.truth.col(b).unaryExpr(kExp);
    batch.input.col(b) = batch.target.col(b);
  };
  const auto mean_error = [](BatchRef x, const Batch& batch) {
    return (x - batch.truth).cwiseAbs().mean();
  };
  return learn(
      o.learning, {.inputs = o.n, .outputs = o.n}, draw,
      {.physics = std::make_unique<Exponential>(o.n),
       .x_error = mean_error,
       .samples = {.draw = sample},
       .series = {.names = {kDecades.begin(), kDecades.end()}, .evaluate = errors_by_decade}});
}

ProblemParts make_exponential(const Options& o, const Draw& draw) {
  if (o.learning.is_on()) return learn_exponential(o, draw);
  const Real n = static_cast<Real>(o.n);
  const Matrix truth = draw.is_published()
                           ? Vector(Vector::LinSpaced(o.n, kSpan / (2 * n), kSpan * (n - 0.5) / n))
                           : Vector(kSpan * draw.stream("target").uniform_vector(o.n, 0, 1));
  return {.physics = std::make_unique<Exponential>(o.n),
          .start = draw.start(Vector::Zero(o.n)),
          .target = truth.unaryExpr(kExp),
          .minimum = 0,
          .truth = truth};
}

}  // namespace

void register_exponential(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "exponential",
       .title = "Exponential",
       .group = Group::toy,
       .formula = "Pᵢ(x) = exp(xᵢ),  L = ½‖P(x) − y*‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 2",
       .note = "Published as a learning problem; seed 0 takes the quantiles of its distribution.",
       .aim = Aim::x,  // P is one to one
       .panels = {{.title = "Fig. 2: x inferred against x*", .kind = "scatter"},
                  {.title = "Error by decade of y*", .kind = "decades"}}},
      make_exponential));
}

}  // namespace isoline::problems
