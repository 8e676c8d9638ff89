// MINPACK, GSL and TinySolver on NIST's certified regressions, against counts and digits of the
// bare libraries (cminpack 1.3.6, GSL 2.7.1, Ceres 2.1); and what their adapters promise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/optimizers/run.h"
#include "tests/optimizers/trial_problems.h"

namespace isoline::optimizers {
namespace {

// Means over the 54 regressions.
struct Sum {
  Real solved = 0, digits = 0, calls = 0;  // to four digits; log relative error; residual calls
};

Outcome on_nist(const std::string& method, const std::string& dataset, int start) {
  return run(make("nist[dataset=" + dataset + ",start=" + std::to_string(start) + "]"), method,
             {.iterations = 100'000, .work = 10'000, .target = 0});
}

Real digits_of(const Outcome& outcome) {
  const Real digits = -std::log10(outcome.trace->last.x_error);
  return std::isnan(digits) ? 0 : std::clamp(digits, 0.0, 11.0);
}

// Means over starts that differ from the published ones by 1e-9. Rounding of the
// loss, which the last steps do not exceed, decides between 7 and 11 digits of a regression: the
// mean over the 54 has a standard deviation of 0.1 over such starts, with the bare libraries, too.
Sum on_nist(const std::string& method) {
  constexpr int kStarts = 8;
  constexpr Real kShift = 1e-9;
  Sum sum;
  for (const OptionField& field : problems::all_problems().at("nist").options)
    for (const std::string& dataset : field.choices)
      for (const int start : {1, 2}) {
        const Problem problem =
            make("nist[dataset=" + dataset + ",start=" + std::to_string(start) + "]");
        RandomStream stream(0, dataset + std::to_string(start), "shifted start");
        for (int i = 0; i < kStarts; ++i) {
          const Vector shift = kShift * stream.normal_vector(problem.unknowns());
          const Outcome outcome =
              run_from(problem.start().cwiseProduct((1 + shift.array()).matrix()), problem, method,
                       {.iterations = 100'000, .work = 10'000, .target = 0});
          sum.solved += (digits_of(outcome) >= 4 ? 1.0 : 0.0) / kStarts;
          sum.digits += digits_of(outcome) / 54 / kStarts;
          sum.calls += static_cast<Real>(
                           outcome.trace->last.counts[static_cast<std::size_t>(Oracle::forward)]) /
                       kStarts;
        }
      }
  return sum;
}

struct Expected {
  const char* method;
  Real solved, digits, calls;  // of the bare library; 0: counted in another way
};

// Each library calls the end of a budget by another name: a failed evaluation, a forced stop.
TEST(Peers, ARunThatWeStopIsStopped) {
  for (const char* method : {"ceres-lm", "ceres-bfgs", "ceres-ncg", "ceres-tiny", "gsl-multifit",
                             "minpack-lmder", "minpack-lmdif", "libdogleg", "nlopt-lbfgs",
                             "nlopt-tnewton", "nlopt-mma", "nlopt-cobyla"}) {
    const Outcome ours =
        run(make("rosenbrock"), method, {.iterations = 100, .work = 10, .target = 0});
    EXPECT_EQ(ours.status, Status::budget) << method;
    EXPECT_STREQ(ours.trace->claimed, "stopped") << method;
    const Outcome own =
        run(make("conduct[input=line]"), method, {.iterations = 10'000, .target = 0});
    EXPECT_STRNE(own.trace->claimed, "stopped") << method;
  }
}

TEST(Peers, HaveTheDigitsOfTheBareLibrariesOnNist) {
  for (const Expected& each :
       {Expected{"minpack-lmder", 54, 9.31, 3719}, Expected{"ceres-lm", 53, 9.41, 0},
        Expected{"ceres-tiny", 53, 9.52, 0}, Expected{"gsl-multifit", 52, 9.40, 0},
        Expected{"minpack-lmder[ftol=1.49012e-8,xtol=1.49012e-8]", 49.5, 6.99, 0}}) {
    const Sum sum = on_nist(each.method);
    EXPECT_NEAR(sum.solved, each.solved, 1) << each.method;
    EXPECT_NEAR(sum.digits, each.digits, 0.2) << each.method;  // two standard deviations
    if (each.calls > 0) {
      EXPECT_NEAR(sum.calls / each.calls, 1, 0.02) << each.method;
    }
  }
}

TEST(Peers, OnlyGeodesicAccelerationSolvesBoxBodFromItsFirstStart) {
  EXPECT_GE(digits_of(on_nist("gsl-multifit[trust-region=lmaccel]", "BoxBOD", 1)), 6);
  for (const char* method : {"ceres-tiny", "gsl-multifit"})
    EXPECT_LT(digits_of(on_nist(method, "BoxBOD", 1)), 1) << method;
}

TEST(Peers, KeepTheirLastIterateWhereTheBudgetEndsWithinAnIteration) {
  const Problem problem = make("rosenbrock");
  for (const char* method : {"minpack-lmder", "minpack-lmdif", "gsl-multifit", "ceres-tiny",
                             "libdogleg", "gsl-multifit[trust-region=lmaccel]"})
    for (std::int64_t work = 20; work < 30; ++work) {
      const Outcome ended = run(problem, method, {.iterations = 1000, .work = work, .target = 0});
      EXPECT_EQ(ended.status, Status::budget) << method << ", work " << work;
      EXPECT_LE(ended.trace->last.loss, 0.5 * ended.trace->start_loss)
          << method << ", work " << work;
    }
}

// Trials are iterations or rejected, each evaluated once; the last Jacobian is the last iterate's.
TEST(Peers, CountEachTrialAsAnIterationOrAsRejected) {
  const Problem problem = make("rosenbrock");
  for (const char* method : {"minpack-lmder", "gsl-multifit", "ceres-tiny", "libdogleg"}) {
    const Outcome outcome = run(problem, method, {.iterations = 1000, .target = 0});
    const Trace& trace = *outcome.trace;
    EXPECT_GT(trace.rejected_steps, 0) << method;
    EXPECT_NEAR(static_cast<Real>(trace.last.counts[static_cast<std::size_t>(Oracle::forward)]),
                static_cast<Real>(1 + trace.last.iteration + trace.rejected_steps), 1)
        << method;
  }
}

TEST(Peers, FactorizeASparseJacobian) {
  const Problem problem = make("broyden-tridiagonal[n=20000]");
  const Outcome outcome = run(problem, "libdogleg", {.iterations = 100, .target = 1e-20});
  EXPECT_EQ(outcome.status, Status::target) << outcome.trace->last.loss;
  EXPECT_LE(outcome.trace->last.iteration, 10);
}

TEST(Peers, WithoutEnoughResidualsAreInapplicable) {
  const Problem wide = linear(Matrix::Ones(1, 2), Vector::Zero(2), Vector::Ones(1));
  for (const char* method : {"minpack-lmder", "minpack-lmdif", "gsl-multifit", "libdogleg"})
    EXPECT_NE(why(method, wide), "") << method;
  EXPECT_EQ(why("ceres-tiny", wide), "");
}

}  // namespace
}  // namespace isoline::optimizers
