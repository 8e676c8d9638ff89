// The Poisson equation on N×N cells of width 1, with the five-point Laplacian and a value 0 one
// width beyond the first and last cell.
//
// poisson: P = ∇⁻², y solves ∇²y = x. Holl, Koltun, Thuerey (2022), Fig. 6a, as a direct problem.
// The authors solve by conjugate gradients to 1e-5; the sine transform is exact. With `jacobi`, a
// network is trained by an inexact solve, of k iterations of Jacobi's method from y = 0,
//
//   y ← ¼(S y − x),  S y the sum over the four neighbours,  Pₖ = ∇⁻²(I − Gᵏ),  G = ¼S,
//
// and judged by the exact one. Pₖ is linear and symmetric, so that both products are k iterations
// again: to differentiate the iterations or to iterate for the adjoint solution is the same. The
// cost of a call is k. More iterations as training goes: Bhatia, Köhler, Thuerey (2025).
//
// poisson-hig, of Schnell, Holl, Thuerey (2022), published scripts: a network sees y* and finds x
// with ∇²x = y* on 8×8 cells, judged by ∇²x, so the physics is y = ∇²x, and its inverse the solve.
// x* is PhiFlow's noise of smoothness 1: white noise over |k|², without its mean, of standard
// deviation 1. The scripts sum the loss over the batch, here it is the mean: their step 0.01 at
// B = 64 is 0.64 here.
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include "core/fourier.h"
#include "problems/learning.h"
#include "problems/random_fields.h"

namespace isoline::problems {
namespace {

template <bool solves>
struct Options {
  Index N = solves ? 64 : 8;
  std::string jacobi;
  Learning learning{
      .network =
          solves ? "unet" : "mlp[layers=64-128-64,activation=tanh,precision=double,init=glorot]",
      .batch = solves ? 128 : 64};
};
template <bool solves>
void fields(Options<solves>& o, auto& field) {
  field("N", o.N, between(2, 1024), "cells along each side");
  if constexpr (solves)
    field("jacobi", o.jacobi, Choices{},
          "in training with mode=learn, iterations of Jacobi's method that solve for y: a number; "
          "converged (to 1e-5); progressive (more of them when the validation loss stops falling)");
  fields(o.learning, field);
}

// ∇² by its stencil, and its inverse: by the sine transform along columns, which leaves of each of
// its waves p a tridiagonal system along rows (Hockney, 1965),
//
//   −y_{j−1} + (2 + s_p) y_j − y_{j+1} = −x_j,  s_p = 4 sin²(πp/2(N+1)),
//
// diagonally dominant, so eliminated without pivots. Grids are columns, (N², B).
template <bool solves>
class Poisson final : public SelfAdjointPhysics {
 public:
  explicit Poisson(Index N) : N_(N), sine_(N), pivots_(N, N) {
    for (Index p = 0; p < N; ++p) {
      const Real angle = std::numbers::pi * static_cast<Real>(p + 1) / static_cast<Real>(N + 1);
      const Real diagonal = 2 + 4 * std::pow(std::sin(angle / 2), 2);
      Real above = 0;
      for (Index j = 0; j < N; ++j) above = pivots_(p, j) = 1 / (diagonal - above);
    }
  }
  Index inputs() const override { return N_ * N_; }
  Index outputs() const override { return N_ * N_; }
  void apply(BatchRef x, BatchOut y) const override { solves ? solve(x, y) : differentiate(x, y); }
  // The stencil is the same of each sample.
  void jacobian(BatchOut J, Workspace& w) const override {
    if (solves) return Physics::jacobian(J, w);
    const Index k = inputs();
    w.unit.setIdentity(k, k);
    differentiate(w.unit, J.leftCols(k));
    for (Index first = k; first < J.cols(); first += k) J.middleCols(first, k) = J.leftCols(k);
  }

  Inverse inverse_kind() const override { return Inverse::exact; }
  Success local_inverse(BatchRef y, BatchRef, BatchRef, BatchOut x) const override {
    solves ? differentiate(y, x) : solve(y, x);
    return Success::Constant(y.cols(), true);
  }

 private:
  void differentiate(BatchRef y, BatchOut x) const {  // x = ∇²y
    for (Index b = 0; b < y.cols(); ++b) {
      const Eigen::Map<const Matrix> Y(y.col(b).data(), N_, N_);
      Eigen::Map<Matrix> X(x.col(b).data(), N_, N_);
      X = -4 * Y;
      X.topRows(N_ - 1) += Y.bottomRows(N_ - 1);
      X.bottomRows(N_ - 1) += Y.topRows(N_ - 1);
      X.leftCols(N_ - 1) += Y.rightCols(N_ - 1);
      X.rightCols(N_ - 1) += Y.leftCols(N_ - 1);
    }
  }
  void solve(BatchRef x, BatchOut y) const {  // ∇²y = x
    const Real scale = -1 / sine_.round_trip();
    for (Index b = 0; b < x.cols(); ++b) {
      const Eigen::Map<const Matrix> X(x.col(b).data(), N_, N_);
      Eigen::Map<Matrix> Y(y.col(b).data(), N_, N_);
      sine_.columns(X, Y);
      Y.col(0) = scale * Y.col(0).cwiseProduct(pivots_.col(0));
      for (Index j = 1; j < N_; ++j)
        Y.col(j) = (scale * Y.col(j) + Y.col(j - 1)).cwiseProduct(pivots_.col(j));
      for (Index j = N_ - 2; j >= 0; --j) Y.col(j) += Y.col(j + 1).cwiseProduct(pivots_.col(j));
      sine_.columns(Y, Y);
    }
  }

  Index N_;
  mutable SineTransform sine_;  // it has scratch
  Matrix pivots_;               // of the elimination, inverted: of wave p in column j, (N, N)
};

// y = Pₖ(x), k the context of a sample; P itself where k is 0.
class PoissonByIterations final : public RefinedPhysics {
 public:
  PoissonByIterations(Index N, const Refinement& refinement)
      : RefinedPhysics(refinement), N_(N), exact_(N) {}
  Index inputs() const override { return exact_.inputs(); }
  Index outputs() const override { return exact_.outputs(); }
  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const override {
    solve(x, c, y, w);
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    solve(v, w.context, Jv, w);
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    solve(u, w.context, JTu, w);
  }
  bool has_curvature() const override { return true; }
  void curvature(BatchRef, BatchOut out, Workspace&) const override { out.setZero(); }
  void curvature_product(BatchRef, BatchRef, BatchOut out, Workspace&) const override {
    out.setZero();
  }
  Inverse inverse_kind() const override { return Inverse::approximate; }  // that of P
  Success local_inverse(BatchRef y, BatchRef x0, BatchRef c, BatchOut x) const override {
    return exact_.local_inverse(y, x0, c, x);
  }

  // The largest eigenvalue of G is cos π/(N+1): the error of every wave is at most 1e-5 of it.
  static Index converged(Index N) {
    constexpr Real kTolerance = 1e-5;
    const Real slowest = std::cos(std::numbers::pi / static_cast<Real>(N + 1));
    return static_cast<Index>(std::ceil(std::log(kTolerance) / std::log(slowest)));
  }

 private:
  void solve(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const {
    w.saved.resize(2);
    auto &last = w.saved[0], &next = w.saved[1];  // with the zeros around, (N + 2, N + 2)
    next.setZero(N_ + 2, N_ + 2);
    for (Index b = 0; b < x.cols(); ++b) {
      if (c(0, b) == 0) {
        exact_.apply(x.col(b), y.col(b));
        continue;
      }
      last.setZero(N_ + 2, N_ + 2);
      const Eigen::Map<const Matrix> X(x.col(b).data(), N_, N_);
      for (auto k = std::lround(c(0, b)); k > 0; --k) {
        next.block(1, 1, N_, N_) = 0.25 * (last.block(0, 1, N_, N_) + last.block(2, 1, N_, N_) +
                                           last.block(1, 0, N_, N_) + last.block(1, 2, N_, N_) - X);
        last.swap(next);
      }
      Eigen::Map<Matrix>(y.col(b).data(), N_, N_) = last.block(1, 1, N_, N_);
    }
  }

  Index N_;
  Poisson<true> exact_;
};

// The authors' problem of Poisson starts with 25 of 600 iterations and adds 10.
Refinement refinement_of(const std::string& iterations, Index N) {
  constexpr Index kFirst = 24, kStep = 60, kMost = 1'000'000;
  const Index all = PoissonByIterations::converged(N);
  if (iterations == "converged") return {.first = all, .most = all};
  if (iterations == "progressive")
    return {.first = 1 + all / kFirst, .step = 1 + all / kStep, .most = all};
  Index k = 0;
  const char* const end = iterations.data() + iterations.size();
  const auto [rest, error] = std::from_chars(iterations.data(), end, k);
  require(error == std::errc() && rest == end && 1 <= k && k <= kMost, [&] {
    return "jacobi must be a number from 1 to 1000000, converged or progressive, got '" +
           iterations + "'";
  });
  return {.first = k, .most = k};
}

// x*. Of poisson-hig the scale of the noise is a factor that the normalization removes, except for
// the smallest wave number that passes, and at a scale of N there is no such limit.
template <bool solves>
Vector noise(Index N, RandomStream& stream) {
  return smooth_noise(N, solves ? 10 : static_cast<Real>(N), 1, stream);
}

template <bool solves>
ProblemParts make_poisson(const Options<solves>& o, const Draw& draw) {
  const Index N = o.N;
  Field field{.rows = N, .columns = N, .x = {"source ∇²y", "1/cell²"}, .y = {"potential"}};
  if (!solves) {
    field.x = {"potential"};
    field.y = {"∇²x", "1/cell²"};
  }
  require(o.jacobi.empty() || o.learning.is_on(), "jacobi requires mode=learn");
  require(o.jacobi != "progressive" || o.learning.data == 0,
          "jacobi=progressive requires new samples in each step; remove data");
  if (!o.learning.is_on()) {
    RandomStream stream = draw.stream("target");
    ProblemParts parts =
        from_exact_data(std::make_unique<Poisson<solves>>(N), noise<solves>(N, stream), draw);
    parts.field = field;
    return parts;
  }
  const auto sample = sample_of(std::make_shared<const Poisson<solves>>(N),
                                [N](RandomStream& stream) { return noise<solves>(N, stream); });
  ProblemParts of{.physics = std::make_unique<Poisson<solves>>(N),
                  .x_error = summed_error,
                  .samples = {.validation = 64, .draw = sample},
                  .field = field};
  if (!o.jacobi.empty()) {
    of.physics = std::make_unique<PoissonByIterations>(N, refinement_of(o.jacobi, N));
    of.samples.contexts = 1;
    of.samples.draw = [sample](RandomStream& stream, Index b, Batch& batch) {
      sample(stream, b, batch);
      batch.context(0, b) = 0;  // exact
    };
  }
  ProblemParts parts =
      learn(o.learning, {.inputs = N * N, .outputs = N * N, .grid = N}, draw, std::move(of));
  if (!solves) add_neurons(parts);
  return parts;
}

}  // namespace

void register_poisson(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "poisson",
       .title = "Poisson equation",
       .group = Group::physics,
       .formula = "P(x) = ∇⁻²x,  L = ½‖P(x) − y*‖²",
       .source = "Holl, Koltun, Thuerey (2022), Fig. 6a",
       .note =
           "x* is smooth noise from our own random streams, for seed 0, too: no instance is "
           "published. The standard start is 0. Published curves sum |x − x*| over cells, and "
           "so does mode=learn; the error of one instance is ‖x − x*‖. P is linear and inverted "
           "exactly, so SIP's target is x* itself: here SIP equals supervised "
           "training on exact labels. With jacobi, networks are trained by an inexact solve and "
           "judged by the exact one; a call counts once for each iteration of its solve.",
       .aim = Aim::x,  // P is one to one
       .family = "laplacian",
       .is_linear = true,
       .panels = {{.title = "Fig. 6b: learning curves", .kind = "curve"},
                  {.title = "Fig. 6a: one sample of the validation", .kind = "pictures"}}},
      make_poisson<true>));
  registry.add(problem_entry(
      {.name = "poisson-hig",
       .title = "Poisson equation, judged by its right-hand side",
       .group = Group::physics,
       .formula = "P(x) = ∇²x,  L = ½‖P(x) − y*‖²",
       .source = "Schnell, Holl, Thuerey (2022), published scripts",
       .note = "Published as a learning problem, with the loss summed over the batch; here it is "
               "the mean, so that η = 0.64 here equals η = 0.01 there at B = 64. The problem "
               "`poisson` has the inverse physics, P = ∇⁻². P is linear and inverted exactly, so "
               "SIP's target is x* itself.",
       .aim = Aim::loss,  // what the published curve shows
       .family = "laplacian",
       .is_linear = true,
       .in_all = false,
       .panels = {{.title = "Learning curves", .kind = "curve"},
                  {.title = "Saturated neurons", .kind = "series", .quantity = "saturated neurons"},
                  {.title = "One sample of the validation", .kind = "pictures"}}},
      make_poisson<false>));
}

}  // namespace isoline::problems
