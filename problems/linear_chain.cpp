// The linear chain of the Physics-based Deep Learning book, chapter on half-inverse gradients: two
// masses on springs, coupled by a third, one of them pushed,
//
//   ẋ = v,  v̇₁ = −x₁ + 0.2 (x₂ − x₁),  v̇₂ = −x₂ − 0.2 (x₂ − x₁) + u(t),
//
// over 24 Runge-Kutta steps of 0.5 in each of which u is constant. They shall return to where they
// began. P is affine in u, P(u; c) = A u + Φ c with A (4, 24) and the initial state c, so its
// inverse is x₀ + A⁺(y − P(x₀; c)), the control nearest x₀; the book cuts singular values of A off
// at 1e-5 of the largest.
#include "core/decompose.h"
#include "problems/oscillators.h"

namespace isoline::problems {
namespace {

constexpr Index kSteps = 24;

struct Options {
  ReturnOptions common{
      .learning = {.network = "mlp[layers=20-20-20,activation=tanh,precision=double,init=glorot]",
                   .batch = 32}};
};
void fields(Options& o, auto& field) { fields(o.common, field); }

class LinearChain final : public Oscillators {
 public:
  LinearChain() : Oscillators({.linear = 0.2, .cubic = 0, .gain = 1}, kSteps, 0.5) {
    Workspace w;
    Matrix A(4, kSteps), Phi(4, 4);
    forward(Matrix::Identity(kSteps, kSteps), Matrix::Zero(4, kSteps), A, w);
    forward(Matrix::Zero(kSteps, 4), Matrix::Identity(4, 4), Phi, w);
    Svd svd;
    require(thin_svd(A, svd), "the chain's Jacobian has no singular values");
    constexpr Real kCutoff = 1e-5;
    const Vector kept =
        (svd.sigma.array() > kCutoff * svd.sigma[0]).select(svd.sigma.cwiseInverse(), 0);
    A_plus_ = svd.Vt.transpose() * kept.asDiagonal() * svd.U.transpose();
    A_plus_A_ = A_plus_ * A;
    A_plus_Phi_ = A_plus_ * Phi;
  }

  bool has_curvature() const override { return true; }
  void curvature(BatchRef, BatchOut out, Workspace&) const override { out.setZero(); }
  void curvature_product(BatchRef, BatchRef, BatchOut out, Workspace&) const override {
    out.setZero();
  }

  Inverse inverse_kind() const override { return Inverse::exact; }
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const override {
    x = x0;
    x.noalias() += A_plus_ * y;
    x.noalias() -= A_plus_A_ * x0;
    x.noalias() -= A_plus_Phi_ * c;
    return Success::Constant(y.cols(), true);
  }

 private:
  Matrix A_plus_, A_plus_A_, A_plus_Phi_;  // (T, 4), (T, T), (T, 4)
};

ProblemParts make_linear_chain(const Options& o, const Draw& draw) {
  const auto physics = std::make_shared<const LinearChain>();
  ProblemParts parts = return_to_start(o.common, std::make_unique<LinearChain>(), draw);
  parts.x_error = [physics](BatchRef x, const Batch& batch) {
    Matrix nearest(x.rows(), x.cols());
    physics->local_inverse(batch.target, x, batch.context, nearest);
    return (nearest - x).colwise().norm().mean();
  };
  return parts;
}

}  // namespace

void register_linear_chain(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "linear-chain",
       .title = "Linear chain",
       .group = Group::physics,
       .formula = "ẍ₁ = −x₁ + 0.2 (x₂ − x₁),  ẍ₂ = −x₂ − 0.2 (x₂ − x₁) + u(t),  y* = the initial "
                  "state",
       .source = "Thuerey et al., Physics-based Deep Learning, chapter on half-inverse gradients; "
                 "Schnell, Holl, Thuerey (2022)",
       .note = "Published as a learning problem, with the loss ‖y − y*‖², loss=square here; by "
               "default half of that, so that 2η here equals η there. mode=direct finds "
               "the 24 controls of one initial state. Infinitely many of them return to it, and "
               "the error in x is the distance from the nearest.",
       .aim = Aim::loss,  // any control that returns will do
       .panels = {{.title = "Learning curves", .kind = "curve"},
                  {.title = "Saturated neurons", .kind = "series", .quantity = "saturated neurons"},
                  {.title = "Path of the first sample",
                   .kind = "path",
                   .quantity = "x1 of the first sample|x2 of the first sample"}}},
      make_linear_chain));
}

}  // namespace isoline::problems
