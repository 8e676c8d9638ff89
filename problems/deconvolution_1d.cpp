// Periodic deconvolution in one dimension: y = A x on N points, A the circulant matrix of a
// Gaussian of standard deviation s = 10 points, normalized to the sum 1,
//
//   Aᵢⱼ = e^(−d²/2s²)/Σ,  d the distance of i and j on the circle.
//
// Riis, Alghamdi, Uribe, Christensen, Afkham, Hansen, Jørgensen (2024), CUQIpy's Deconvolution1D
// with its defaults: N = 128, x* = sinc(5t) for t evenly from −1 to 1. The noise of 0.01 there is
// the option noise of every problem here. Other instances have sinc(p (t − c)).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "problems/learning.h"

namespace isoline::problems {
namespace {

struct Deconvolution1d {
  Index N = 128, refine = 1;
  Real width = 10;
};
void fields(Deconvolution1d& o, auto& field) {
  field("N", o.N, between(2, 2048), "points");
  field("width", o.width, above(0), "standard deviation s of the Gaussian, in points");
  field("refine", o.refine, between(1, 16),
        "data of so many times as many points, of which each refine-th counts");
}

class Convolution final : public SelfAdjointPhysics {
 public:
  Convolution(Index N, Real width) : A_(N, N) {
    Vector kernel(N);  // by the distance to the right
    for (Index d = 0; d < N; ++d) {
      const Real nearest = static_cast<Real>(std::min(d, N - d)) / width;
      kernel[d] = std::exp(-nearest * nearest / 2);
    }
    kernel /= kernel.sum();
    for (Index j = 0; j < N; ++j)
      for (Index i = 0; i < N; ++i) A_(i, j) = kernel[std::abs(i - j)];
  }
  Index inputs() const override { return A_.rows(); }
  Index outputs() const override { return A_.rows(); }
  void apply(BatchRef x, BatchOut y) const override { y.noalias() = A_ * x; }
  void jacobian(BatchOut J, Workspace&) const override {
    for (Index first = 0; first < J.cols(); first += A_.cols()) J.middleCols(first, A_.cols()) = A_;
  }

 private:
  Matrix A_;  // (N, N)
};

// At N points, each a `refine`-th of the unit apart.
Vector truth_of(Index N, Index refine, const Draw& draw) {
  Real p = 5, c = 0;
  if (!draw.is_published()) {
    RandomStream stream = draw.stream("target");
    p = stream.uniform(3, 7);
    c = stream.uniform(-0.5, 0.5);
  }
  Vector truth(N * refine);
  for (Index i = 0; i < truth.size(); ++i) {
    const Real t = -1 + 2 * static_cast<Real>(i) / static_cast<Real>(refine * (N - 1));
    const Real angle = std::numbers::pi * p * (t - c);
    truth[i] = angle == 0 ? 1 : std::sin(angle) / angle;
  }
  return truth;
}

ProblemParts make_deconvolution_1d(const Deconvolution1d& o, const Draw& draw) {
  ProblemParts parts = from_exact_data(std::make_unique<Convolution>(o.N, o.width),
                                       truth_of(o.N, 1, draw), draw, StartScale::own);
  if (o.refine == 1) return parts;
  const Real width = o.width * static_cast<Real>(o.refine);
  Matrix fine(o.N * o.refine, 1);
  Convolution(fine.rows(), width).apply(truth_of(o.N, o.refine, draw), fine);
  for (Index i = 0; i < o.N; ++i) parts.target(i, 0) = fine(i * o.refine, 0);
  return parts;
}

}  // namespace

void register_deconvolution_1d(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "deconvolution-1d",
       .title = "Deconvolution in one dimension",
       .group = Group::physics,
       .formula = "P(x)ᵢ = Σⱼ h(|i − j|) xⱼ,  h a periodic Gaussian,  L = ½‖P(x) − y*‖²",
       .source = "Riis, Alghamdi, Uribe, Christensen, Afkham, Hansen, Jørgensen (2024), CUQIpy",
       .note = "CUQIpy’s data have noise of 0.01: run it with the option noise. Every start is 0. "
               "The smallest singular values of A are about 1e-10 of the largest one.",
       .aim = Aim::x,
       .family = "gaussian-blur",
       .is_linear = true,
       .in_all = false},
      make_deconvolution_1d));
}

}  // namespace isoline::problems
