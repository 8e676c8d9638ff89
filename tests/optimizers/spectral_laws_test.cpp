// The laws of spectral steps, by every way to compute them.
#include "spectral_trial.h"

namespace isoline::optimizers {

using problems::Point;
namespace {

constexpr Real kKappas[] = {-1, 0, 0.25, 0.5, 0.75, 1};

// L → c L, y → s y, on a network's wide Jacobian.
Problem scaled(Real loss, Real output) {
  const Matrix M = output * easy_matrix();
  Matrix input(2, 2), truth(2, 2);
  input << 0.3, -0.8, 0.5, 0.1;
  truth << 1, 2, -1, 0.5;
  RandomStream start(1, "trial", "start");
  auto affine = std::make_unique<Affine>(2, 2);
  Vector theta = affine->start(start);
  return Problem({.physics = std::make_unique<Linear>(M),
                  .start = std::move(theta),
                  .target = M * truth,
                  .network = std::move(affine),
                  .input = input,
                  .loss = std::make_unique<HalfSquared>(loss),
                  .minimum = 0});
}

TEST(SpectralStep, ScalesWithTheLossAndWithThePower1MinusKappaOfTheOutput) {
  constexpr Real kScale = 7;
  for (const Way way : {Way::svd, Way::qr, Way::gram, Way::layers, Way::automatic})
    for (const Real kappa : kKappas) {
      const auto step = [&](const Problem& problem) {
        return step_of(problem, problem.start(), way, power_filter(kappa, 1e-6)).step;
      };
      const Vector one = step(scaled(1, 1));
      expect_near(step(scaled(kScale, 1)), kScale * one, 1e-10, "loss");
      expect_near(step(scaled(1, kScale)), std::pow(kScale, 1 - kappa) * one, 1e-10, "output");
    }
}

// B copies of a sample: exponent −(1+κ)/2 for every κ.
TEST(SpectralStep, ScalesWithMinusHalfOf1PlusKappaOfEqualSamples) {
  constexpr Index kCopies = 5;
  const auto copies = [](Index count) {
    RandomStream start(1, "trial", "start");
    auto affine = std::make_unique<Affine>(2, 2);
    Vector theta = affine->start(start);
    return Problem({.physics = std::make_unique<Linear>(easy_matrix()),
                    .start = std::move(theta),
                    .target = Eigen::Vector2d(1, -2).replicate(1, count),
                    .network = std::move(affine),
                    .input = Eigen::Vector2d(0.4, -0.7).replicate(1, count),
                    .minimum = 0});
  };
  for (const Way way : {Way::svd, Way::qr, Way::gram, Way::automatic})
    for (const Real kappa : kKappas) {
      const SpectralFilter filter = power_filter(kappa, 1e-6);
      const Vector one = step_of(copies(1), copies(1).start(), way, filter).step;
      const Vector many = step_of(copies(kCopies), copies(kCopies).start(), way, filter).step;
      expect_near(many, std::pow(kCopies, -(1 + kappa) / 2) * one, 1e-10, std::to_string(kappa));
    }
}

TEST(SpectralStep, KappaMinusOneIsTheGradient) {
  const Problem problem = network("8");
  Point at;
  Matrix g(problem.outputs(), problem.samples());
  Vector gradient(problem.unknowns());
  problem.forward(problem.start(), at);
  problem.cotangent(at, g);
  problem.pullback(g, gradient, at);
  for (const Way way : {Way::svd, Way::qr, Way::gram, Way::layers, Way::lanczos})
    expect_near(step_of(problem, problem.start(), way, power_filter(-1, 0)).step, -gradient, 1e-10,
                "gradient");
}

// κ = 1 without truncation, J of full row rank.
TEST(SpectralStep, KappaOneTakesTheLinearizedOutputAllTheWay) {
  const Problem problem = network("8");
  Point at;
  Matrix g(problem.outputs(), problem.samples()), J;
  problem.forward(problem.start(), at);
  problem.cotangent(at, g);
  problem.jacobian(J, at);
  for (const Way way : {Way::svd, Way::qr, Way::orthogonal, Way::automatic}) {
    const Vector step = step_of(problem, problem.start(), way, truncated_inverse_filter(0)).step;
    expect_near(J * step, -g.reshaped(), 1e-10, "J Δθ");
  }
}

}  // namespace
}  // namespace isoline::optimizers
