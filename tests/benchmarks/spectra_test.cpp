// Singular values of J along a run: those of the J that its steps see, kept where they are asked
// for, and no part of its result.
#include <csignal>

#include "benchmarks/merge/merge.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/same_result.h"
#include "core/decompose.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {
namespace {

Request request_of(const std::string& problem, const std::string& optimizer,
                   std::int64_t iterations) {
  MatrixBlock block{.problems = {problem},
                    .optimizers = {optimizer},
                    .budget = {.iterations = iterations, .target = 0}};
  block.seeds = {0};
  return expand(catalog(), {.name = "mine", .title = "", .blocks = {block}}, {}).at(0);
}

// Of the J of the batch at θ, by the thin SVD.
std::vector<Real> singular_values_at(const Problem& problem, const Vector& theta) {
  problems::Point at;
  Matrix J;
  Svd svd;
  problem.forward(theta, problem.batch(), at);
  problem.jacobian(J, at);
  EXPECT_TRUE(thin_svd(J, svd));
  return {svd.sigma.begin(), svd.sigma.end()};
}

class Spectra : public testing::Test {
 protected:
  Record run(const Request& request, const RunOptions& options) {
    Store store(folder_.path());
    outcome = run_all(catalog(), {request}, store, options);
    return store.find(request).value();
  }

  Outcome outcome;

 private:
  TemporaryFolder folder_;
};

TEST_F(Spectra, AreThoseOfTheJacobianAtPowersOfTwoAndTheLast) {
  const Request request = request_of("rosenbrock", "gd[rate=1e-4]", 11);
  const Record record = run(request, {.jobs = 1, .keeps_spectra = true});
  ASSERT_TRUE(record.spectrum);
  EXPECT_EQ(record.spectrum->iterations, (std::vector<std::int64_t>{0, 1, 2, 4, 8, 11}));
  const Problem problem = make_problem(catalog(), request.problem, 0);
  const std::vector<Real> first = singular_values_at(problem, problem.start());
  ASSERT_EQ(record.spectrum->sigma.front().size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_NEAR(record.spectrum->sigma.front()[i], first[i], 1e-13 * first[0]);
  EXPECT_NE(record.spectrum->sigma.front(), record.spectrum->sigma.back()) << "J is not constant";
}

// After 100 iterations only some are kept; none is kept for its spectrum alone.
TEST_F(Spectra, OfLongRunsStandAtKeptIterations) {
  const Record record =
      run(request_of("rosenbrock", "gd[rate=1e-4]", 300), {.jobs = 1, .keeps_spectra = true});
  const std::vector<std::int64_t>& at = record.spectrum.value().iterations;
  for (const std::int64_t iteration : at)
    EXPECT_EQ(std::ranges::count(record.curve.iteration, iteration), 1) << iteration;
  EXPECT_EQ(at.back(), record.summary.iterations);
  EXPECT_GE(at.at(8), 128);
}

TEST_F(Spectra, OfALearnedProblemAreOfTheBatchOfTheStep) {
  const Request request = request_of("linear-chain[mode=learn,batch=2]", "adam", 3);
  const Record record = run(request, {.jobs = 1, .keeps_spectra = true});
  const Problem problem = make_problem(catalog(), request.problem, 0);
  const std::vector<Real> first = singular_values_at(problem, problem.start());
  const Spectrum& spectrum = record.spectrum.value();
  EXPECT_EQ(spectrum.iterations, (std::vector<std::int64_t>{0, 1, 2, 3}));
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_NEAR(spectrum.sigma.front().at(i), first[i], 1e-13 * first[0]);
}

TEST_F(Spectra, AreNoPartOfTheResult) {
  const Request request = request_of("linear-chain[mode=learn,batch=2]", "adam", 20);
  const Record without = run(request, {.jobs = 1});
  EXPECT_FALSE(without.spectrum);
  const Record with = run(request, {.jobs = 1, .keeps_spectra = true});
  ASSERT_TRUE(with.spectrum) << "a record without them is made anew";
  EXPECT_TRUE(same_result(without, with));
  Record other = with;
  other.spectrum->sigma[1][0] *= 1 + 1e-15;
  EXPECT_FALSE(same_result(with, other)) << "of two that both keep them they are compared";
}

TEST_F(Spectra, OfARecordThatHasThemAreNotMadeAgain) {
  const Request request = request_of("rosenbrock", "gd[rate=1e-4]", 5);
  run(request, {.jobs = 1, .keeps_spectra = true});
  run(request, {.jobs = 1, .keeps_spectra = true});
  EXPECT_EQ(outcome.reused, 1);
  EXPECT_TRUE(run(request, {.jobs = 1, .repeat = 2}).spectrum) << "timed again without them";
}

TEST_F(Spectra, AreMergedWithTheRecordThatHasThem) {
  const Request request = request_of("rosenbrock", "gd[rate=1e-4]", 5);
  const TemporaryFolder a, b, place;
  for (const auto& [folder, keeps] : {std::pair(&a, false), {&b, true}}) {
    Store store(folder->path());
    run_all(catalog(), {request}, store, {.jobs = 1, .keeps_spectra = keeps});
  }
  const auto name = Store(b.path()).find(request).value().file_name();
  for (const auto& folders : {std::vector{a.path(), b.path()}, {b.path(), a.path()}}) {
    const auto out = place.path() / folders[0].filename();
    EXPECT_TRUE(merge_folders(folders, out).conflicts.empty());
    EXPECT_TRUE(read_record(out / "runs" / name).spectrum);
  }
}

// There is nothing to keep, and the cell counts as done.
TEST_F(Spectra, OfAJacobianThatIsTooLargeAreNone) {
  const Request request = request_of("heat[N=64]", "gd", 2);
  ASSERT_GT(make_problem(catalog(), request.problem, 0).residuals(), Trace::Spectra::kValues);
  EXPECT_TRUE(run(request, {.jobs = 1, .keeps_spectra = true}).spectrum.value().iterations.empty());
  run(request, {.jobs = 1, .keeps_spectra = true});
  EXPECT_EQ(outcome.reused, 1);
}

TEST_F(Spectra, OfARunThatWasStoppedAndGoneOnAreThoseOfOneThatWasNot) {
  const TemporaryFolder folder;
  const Request request = request_of("linear-chain[mode=learn,batch=2]", "adam", 9);
  const auto spectrum_of = [&](Checkpoint checkpoint) {
    const auto trace = std::make_unique<Trace>();
    trace->spectra.are_wanted = true;
    execute(catalog(), request, *trace, std::move(checkpoint));
    return std::pair(trace->status, benchmarks::record_of(request, *trace).spectrum);
  };
  const auto whole = spectrum_of({}).second;
  ASSERT_EQ(whole.value().iterations, (std::vector<std::int64_t>{0, 1, 2, 4, 8, 9}));
  int pieces = 0;
  for (;; ++pieces) {
    Checkpoint checkpoint(folder.path() / "state", "cell", 0);
    std::raise(SIGTERM);  // it is stopped after a step
    const auto [status, spectrum] = spectrum_of(std::move(checkpoint));
    if (status == Status::interrupted) continue;
    EXPECT_EQ(spectrum, whole);
    break;
  }
  EXPECT_GT(pieces, 3);
}

}  // namespace
}  // namespace isoline::benchmarks
