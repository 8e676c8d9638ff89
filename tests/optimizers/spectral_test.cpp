// Each factorization to compute a spectral step against the thin SVD, and the laws of spectral
// steps.
#include <gtest/gtest.h>

#include "optimizers/spectral_step.h"
#include "tests/optimizers/run.h"
#include "tests/optimizers/trial_problems.h"

namespace isoline::optimizers {
namespace {

SpectralFilter clamped(Real kappa, Real cutoff) {
  return {.kappa = kappa, .cutoff = cutoff, .clamps = true};
}

// Three layers in double; `batch` samples of two outputs each make J wide up to 98.
Problem network(const std::string& batch, const std::string& activation = "tanh") {
  return make("sine[mode=learn,xi=2,network=mlp[layers=12-12,precision=double,activation=" +
              activation + "],batch=" + batch + ",data=" + batch + "]");
}

constexpr OracleSet kAll{Oracle::forward, Oracle::jacobian, Oracle::pullback, Oracle::pushforward,
                         Oracle::layer_factors};

struct Computed {
  Vector step;  // −V f(σ) Uᵀ g
  std::string said;
  Real estimate = 0;  // of the error by a Gram matrix
};

Computed step_of(const Problem& problem, const Vector& theta, Factorization factorization,
                 const SpectralFilter& filter, const KrylovLimits& krylov = {},
                 const OracleSet& granted = kAll) {
  const auto trace = std::make_unique<Trace>();
  Meter meter(problem, iterations(10), granted, *trace);
  Vector start = theta;
  meter.begin(start);
  SpectralStep spectral(factorization, krylov);
  spectral.start(meter);
  Linearization at;
  meter.linearize(theta, at);
  Matrix g;
  at.cotangent(g);
  Vector step = Vector::Zero(theta.size());
  EXPECT_TRUE(spectral.add(meter, at, filter, g.reshaped(), -1, step));
  return {step, trace->claimed, spectral.error_by_gram()};
}

// Wide, tall and square; at the start, and where 30 steps have led.
void for_some_points(const std::function<void(const Problem&, const Vector&)>& check) {
  struct Trained {
    Problem problem;
    Vector theta;
  };
  static const std::vector<Trained> all = [] {
    std::vector<Trained> made;
    for (const char* activation : {"tanh", "relu"})
      for (const char* batch : {"8", "97", "150"}) {
        Problem problem = network(batch, activation);
        Vector theta = run(problem, "hig[rate=0.1,factorization=svd]", iterations(30)).theta;
        made.push_back({std::move(problem), std::move(theta)});
      }
    return made;
  }();
  for (const auto& [problem, theta] : all) {
    check(problem, problem.start());
    check(problem, theta);
  }
}

// Of which a Gram matrix, too, gives the step to 1e-8, wherever the spectrum lies.
const SpectralFilter kFilters[] = {power_filter(-1, 0),         power_filter(0, 1e-3),
                                   power_filter(0.25, 1e-3),    power_filter(0.5, 1e-3),
                                   power_filter(0.75, 1e-3),    power_filter(1, 1e-3),
                                   tikhonov_filter(1e-3),       decaying_filter(0.5, 1e-6),
                                   decaying_filter(0.75, 1e-6), decaying_filter(1, 1e-6)};

std::string filter_text(const SpectralFilter& filter, const Problem& problem) {
  return "κ " + std::to_string(filter.kappa) + ", μ " + std::to_string(filter.damping) + ", " +
         std::to_string(problem.residuals()) + " × " + std::to_string(problem.unknowns());
}

TEST(SpectralStep, EveryFactorizationAgreesWithTheSvd) {
  for_some_points([](const Problem& problem, const Vector& theta) {
    const bool is_wide = problem.residuals() < problem.unknowns();
    for (const SpectralFilter& filter : kFilters) {
      const Vector reference = step_of(problem, theta, Factorization::svd, filter).step;
      const std::string what = filter_text(filter, problem);
      expect_near(step_of(problem, theta, Factorization::qr, filter).step, reference, 1e-10,
                  "qr, " + what);
      expect_near(step_of(problem, theta, Factorization::gram, filter).step, reference, 1e-8,
                  "gram, " + what);
      for (const Factorization factorization : {Factorization::layers, Factorization::split})
        if (is_wide)
          expect_near(step_of(problem, theta, factorization, filter).step, reference, 1e-8,
                      std::string(factorization_text(factorization)) + ", " + what);
    }
    const SpectralFilter damped = tikhonov_filter(1e-4);
    const Vector reference = step_of(problem, theta, Factorization::svd, damped).step;
    expect_near(step_of(problem, theta, Factorization::cholesky, damped).step, reference, 1e-8,
                "cholesky, " + filter_text(damped, problem));
  });
}

// All σ within a hundredth of the largest, so that a Gram matrix rounds none of them away; some lie
// below the cut-off, and count as it.
TEST(SpectralStep, EveryFactorizationClampsAlike) {
  const Problem problem = network("3");
  for (const Real kappa : {0.5, 1.0}) {
    const SpectralFilter filter = clamped(kappa, 0.3);
    const Vector reference = step_of(problem, problem.start(), Factorization::svd, filter).step;
    const Vector discarded =
        step_of(problem, problem.start(), Factorization::svd, power_filter(kappa, 0.3)).step;
    EXPECT_GT((discarded - reference).norm(), 0.01 * reference.norm());
    for (const Factorization factorization :
         {Factorization::qr, Factorization::gram, Factorization::layers, Factorization::split,
          Factorization::automatic})
      expect_near(step_of(problem, problem.start(), factorization, filter).step, reference, 1e-10,
                  std::string(factorization_text(factorization)));
    expect_near(
        step_of(problem, problem.start(), Factorization::lanczos, filter, {.tolerance = 0}).step,
        reference, 1e-10, "Lanczos");
  }
}

// With the published cut-offs, at which a Gram matrix alone would not do. The reference itself
// knows a σ to rounding of the largest, so that a share of 1e-10 is left out here.
TEST(SpectralStep, TheAutomaticFactorizationAgreesWithTheSvd) {
  for_some_points([](const Problem& problem, const Vector& theta) {
    for (const Real cutoff : {1e-7, 1e-6, 1e-5, 1e-4})
      for (const Real kappa : {0.5, 1.0}) {
        const SpectralFilter filter = power_filter(kappa, cutoff);
        expect_near(step_of(problem, theta, Factorization::automatic, filter).step,
                    step_of(problem, theta, Factorization::svd, filter).step, 1e-8,
                    std::to_string(cutoff) + ", " + filter_text(filter, problem));
      }
  });
}

// At the cut-offs and rates of the paper, in smaller batches; where the half of the digits that a
// Gram matrix squares away is too much, it is split, and QR is left for the least cut-off.
TEST(SpectralStep, OfThePublishedProblemsAgreesWithTheSvd) {
  const std::string split = ", split in two";
  for (const auto& [spec, cutoff, method, said] :
       {std::tuple{"linear-chain[mode=learn,batch=16]", 1e-10, "hig[rate=2,cutoff=1e-10]",
                   std::string(" SVD of R")},
        {"coupled-oscillators[mode=learn,batch=32]", 1e-6, "hig[rate=2]", split},
        {"quantum-dipole[mode=learn,batch=2]", 1e-5, "hig[rate=0.5,cutoff=1e-5]", split}}) {
    const Problem problem = make(spec);
    for (const int steps : {0, 100}) {
      const Vector theta =
          steps > 0 ? run(problem, method, iterations(steps)).theta : problem.start();
      const SpectralFilter filter = power_filter(0.5, cutoff);
      const Computed automatic = step_of(problem, theta, Factorization::automatic, filter);
      expect_near(automatic.step, step_of(problem, theta, Factorization::svd, filter).step, 1e-8,
                  spec);
      EXPECT_TRUE(automatic.said.ends_with(said)) << spec;
    }
  }
}

// To an order of magnitude, which is what the automatic factorization relies on.
TEST(SpectralStep, TheErrorOfAGramMatrixIsEstimated) {
  for_some_points([](const Problem& problem, const Vector& theta) {
    for (const Real cutoff : {1e-4, 1e-3}) {
      const SpectralFilter filter = power_filter(1, cutoff);
      const Vector reference = step_of(problem, theta, Factorization::svd, filter).step;
      const Computed by_gram = step_of(problem, theta, Factorization::gram, filter);
      const Real error = (by_gram.step - reference).norm() / reference.norm();
      EXPECT_LE(error, 5 * by_gram.estimate) << filter_text(filter, problem);
      EXPECT_LE(by_gram.estimate, cutoff < 1e-3 ? 1e-6 : 1e-8) << filter_text(filter, problem);
    }
  });
}

// y = diag(1, share) x: the least singular value decides, and the run says what was done.
TEST(SpectralStep, TheAutomaticFactorizationIsChosenByTheLeastSingularValueKept) {
  const auto said = [](Real share, const SpectralFilter& filter) {
    const Matrix M = Eigen::Vector2d(1, share).asDiagonal();
    const Problem problem = linear(M, Eigen::Vector2d(1, 1), Eigen::Vector2d(0, 0));
    return step_of(problem, problem.start(), Factorization::automatic, filter, {},
                   {Oracle::forward, Oracle::jacobian})
        .said;
  };
  const std::string by_gram = "steps by the Gram", by_qr = "steps by QR";
  EXPECT_TRUE(said(1e-3, power_filter(0.5, 1e-6)).starts_with(by_gram));
  EXPECT_TRUE(said(5e-6, power_filter(0.5, 1e-6)).starts_with(by_qr));
  EXPECT_TRUE(said(5e-7, power_filter(0.5, 1e-6)).starts_with(by_gram));  // discarded
  EXPECT_TRUE(said(0.1, power_filter(0.5, 1e-8)).starts_with(by_qr));
  EXPECT_TRUE(said(1e-9, decaying_filter(0.5, 1e-4)).starts_with(by_gram));  // decays
  EXPECT_TRUE(said(1e-9, decaying_filter(0.5, 1e-12)).starts_with(by_qr));
  EXPECT_TRUE(said(1e-9, tikhonov_filter(1e-3)).starts_with("steps by Cholesky"));
  EXPECT_TRUE(said(1e-9, tikhonov_filter(1e-12)).starts_with(by_qr));
}

TEST(SpectralStep, ANetworkOfDenseLayersIsTreatedLayerByLayerWhereJIsWide) {
  const Problem wide = network("8"), tall = network("200");
  const auto needs = [](const Problem& problem) {
    return needs_of(Factorization::automatic, power_filter(0.5, 1e-6), problem);
  };
  EXPECT_TRUE(needs(wide).contains(Oracle::layer_factors));
  EXPECT_FALSE(needs(tall).contains(Oracle::layer_factors));
  EXPECT_TRUE(step_of(wide, wide.start(), Factorization::automatic, power_filter(0.5, 1e-2))
                  .said.ends_with(" layer by layer"));
  EXPECT_NE(objection_to(Factorization::layers, tall), "");
}

// Small σ carry a large part of the step, and the estimate must still be no less than the error.
TEST(SpectralStep, LanczosComesAsNearAsItSays) {
  for_some_points([](const Problem& problem, const Vector& theta) {
    for (const SpectralFilter& filter :
         {power_filter(-1, 0), power_filter(0, 1e-2), power_filter(0.5, 1e-2),
          decaying_filter(0.5, 1e-4), decaying_filter(1, 1e-4)}) {
      const Vector reference = step_of(problem, theta, Factorization::svd, filter).step;
      expect_near(step_of(problem, theta, Factorization::lanczos, filter, {.tolerance = 1e-3}).step,
                  reference, 1e-3, filter_text(filter, problem));
      expect_near(step_of(problem, theta, Factorization::lanczos, filter, {.tolerance = 0}).step,
                  reference, 1e-8, "whole space, " + filter_text(filter, problem));
    }
  });
}

TEST(SpectralStep, LanczosKeepsToItsVectorsAndSaysHowFarItCame) {
  const Problem problem = network("40");
  const Outcome result = run(
      problem, "hig[factorization=lanczos,cutoff=1e-2,krylov-vectors=7,rate=1e-2]", iterations(3));
  EXPECT_EQ(result.trace->last.series[0], 7);
  EXPECT_GT(result.trace->last.series[1], 1e-3);
  EXPECT_STREQ(result.trace->claimed, "steps by Lanczos");
}

TEST(Filters, AreTheirFormulas) {
  const Spectrum of{.largest = 4, .mean_square = 3};
  EXPECT_EQ(power_filter(-1, 0)(0.7, of), 0.7);
  EXPECT_DOUBLE_EQ(power_filter(0.5, 0.1)(2, of), 1 / std::sqrt(2.0));
  EXPECT_EQ(power_filter(0.5, 0.5)(2, of), 0);  // strictly greater
  EXPECT_DOUBLE_EQ(clamped(1, 0.5)(1e-9, of), 0.5);
  for (const Real sigma : {1e-9, 0.7, 3.0})  // a function of σ², times σ
    EXPECT_DOUBLE_EQ(sigma * clamped(0.5, 0.5).over_sigma(sigma, of), clamped(0.5, 0.5)(sigma, of));
  EXPECT_DOUBLE_EQ(power_filter(1, 0.1)(2, of), 0.5);
  EXPECT_DOUBLE_EQ(tikhonov_filter(0.5)(2, of), 2 / (4 + 1.5));
  EXPECT_DOUBLE_EQ(decaying_filter(0.5, 0.25)(2, of), 2 / std::pow(4 + 4, 0.75));
}

// The laws of spectral steps, by every factorization to compute them.

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
  for (const Factorization factorization :
       {Factorization::svd, Factorization::qr, Factorization::gram, Factorization::layers,
        Factorization::automatic})
    for (const Real kappa : kKappas) {
      const auto step = [&](const Problem& problem) {
        return step_of(problem, problem.start(), factorization, power_filter(kappa, 1e-6)).step;
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
  for (const Factorization factorization :
       {Factorization::svd, Factorization::qr, Factorization::gram, Factorization::automatic})
    for (const Real kappa : kKappas) {
      const SpectralFilter filter = power_filter(kappa, 1e-6);
      const Vector one = step_of(copies(1), copies(1).start(), factorization, filter).step;
      const Vector many =
          step_of(copies(kCopies), copies(kCopies).start(), factorization, filter).step;
      expect_near(many, std::pow(kCopies, -(1 + kappa) / 2) * one, 1e-10, std::to_string(kappa));
    }
}

TEST(SpectralStep, KappaMinusOneIsTheGradient) {
  const Problem problem = network("8");
  const Vector gradient = gradient_at(problem, problem.start());
  for (const Factorization factorization :
       {Factorization::svd, Factorization::qr, Factorization::gram, Factorization::layers,
        Factorization::lanczos})
    expect_near(step_of(problem, problem.start(), factorization, power_filter(-1, 0)).step,
                -gradient, 1e-10, "gradient");
}

}  // namespace
}  // namespace isoline::optimizers
