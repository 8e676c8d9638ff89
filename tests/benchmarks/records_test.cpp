// Properties of every record, over every problem with every optimizer.
#include <cmath>
#include <limits>
#include <numeric>

#include "benchmarks/plan/catalog.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
using optimizers::why_inapplicable;
using problems::Problem;

namespace {

constexpr std::int64_t kIterations = 300, kSlowIterations = 10;

// Every problem, grids small, with every optimizer at the rates of the tree.
const FinishedMatrix& matrix() {
  static const FinishedMatrix all = [] {
    std::vector<std::string> problems, slow;
    for (const auto& [name, entry] : catalog().problems.ready()) {
      const bool has_size = complete_problem(catalog(), name, OptionValues()).options.contains("N");
      (entry.in_all ? problems : slow).push_back(has_size ? name + "[N=8]" : name);
    }
    const auto block = [](const std::vector<std::string>& some,
                          std::int64_t iterations) -> MatrixBlock {
      return {.problems = some,
              .optimizers = catalog().optimizers.ready().names(),
              .seeds = {1},
              .budget = {.iterations = iterations, .work = 5 * iterations}};
    };
    const Suite suite{.name = "all",
                      .title = "",
                      .blocks = {block(problems, kIterations), block(slow, kSlowIterations)}};
    return FinishedMatrix(catalog(), suite, Rates::builtin());
  }();
  return all;
}

bool has_run(const Record& record) { return record.status != Status::inapplicable; }

TEST(Records, OfTheWholeRegistryConformToTheSchemaAndSurviveTheRoundTrip) {
  const Json form = schema("run");
  for (const Record& record : matrix().records) {
    const Json json = to_json(record);
    EXPECT_EQ(schema_violations(json, form), std::vector<std::string>{}) << title_of(record);
    EXPECT_EQ(to_json(record_from_text(json_text(json), "it")), json) << title_of(record);
  }
}

TEST(Records, NoPairOfTheRegistryFailsCrashesOrHangs) {
  EXPECT_EQ(matrix().outcome.failures, std::vector<std::string>{});
  EXPECT_EQ(matrix().records.size(),
            catalog().problems.ready().size() * catalog().optimizers.ready().size());
}

TEST(Records, CellsThatCannotExistSayWhy) {
  std::size_t count = 0;
  for (const Record& record : matrix().records) {
    const Problem problem = make_problem(catalog(), record.request.problem, 1);
    const Component& optimizer = record.request.optimizer;
    const std::string reason =
        why_inapplicable(catalog().optimizers.at(optimizer.name), optimizer.options, problem);
    EXPECT_EQ(record.status == Status::inapplicable, !reason.empty()) << title_of(record);
    if (has_run(record)) continue;
    EXPECT_EQ(record.message, reason) << title_of(record);
    EXPECT_TRUE(record.curve.iteration.empty()) << title_of(record);
    EXPECT_EQ(record.summary.work, 0) << title_of(record);
    ++count;
  }
  EXPECT_GT(count, 0U);
}

TEST(Records, CurvesKeepIterations0To100And32ADecadeAfterInColumnsThatEndAtTheSummary) {
  std::set<std::int64_t> grid;
  for (int j = 64; j <= 96; ++j) grid.insert(std::llround(std::pow(10.0, j / 32.0)));
  for (const Record& record : matrix().records) {
    SCOPED_TRACE(title_of(record));
    const Curve& curve = record.curve;
    const auto& iteration = curve.iteration;
    const std::size_t points = iteration.size();
    for (std::size_t i = 0; i + 1 < points; ++i)  // the last is kept wherever it falls
      EXPECT_TRUE(i <= 100 ? iteration[i] == static_cast<std::int64_t>(i)
                           : grid.contains(iteration[i]))
          << iteration[i];
    EXPECT_EQ(curve.work.size(), points);
    for (const auto* column : {&curve.wall_seconds, &curve.processor_seconds, &curve.loss,
                               &curve.x_error, &curve.gradient_norm, &curve.step_norm})
      EXPECT_EQ(column->size(), points);
    for (const auto& [oracle, counts] : curve.counts) EXPECT_EQ(counts.size(), points) << oracle;
    if (!has_run(record)) continue;
    EXPECT_EQ(iteration.back(), record.summary.iterations);
    EXPECT_EQ(curve.loss.front(), record.summary.start_loss);
    EXPECT_EQ(curve.work.back(), record.summary.work);
    if (std::isnan(record.summary.loss)) continue;  // equal to nothing
    EXPECT_EQ(curve.loss.back(), record.summary.loss);
  }
}

std::int64_t priced(const OracleCounts& counts, const OracleCounts& prices) {
  return std::inner_product(counts.begin(), counts.end(), prices.begin(), std::int64_t{0});
}

TEST(Records, WorkIsCountsTimesPricesThroughout) {
  for (const Record& record : matrix().records) {
    EXPECT_EQ(record.summary.work, priced(record.counts, record.prices)) << title_of(record);
    for (std::size_t i = 0; i < record.curve.work.size(); ++i) {
      OracleCounts counts{};
      for (std::size_t kind = 0; kind < kOracles; ++kind) {
        const auto column = record.curve.counts.find(std::string(kOracleNames[kind]));
        if (column != record.curve.counts.end()) counts[kind] = column->second[i];
      }
      EXPECT_EQ(record.curve.work[i], priced(counts, record.prices)) << title_of(record) << i;
    }
  }
}

TEST(Records, BudgetsAreObeyed) {
  for (const Record& record : matrix().records) {
    const Budget& budget = record.request.budget;
    EXPECT_LE(record.summary.iterations, budget.iterations) << title_of(record);
    EXPECT_LE(record.summary.work, budget.work) << title_of(record);
    if (record.hits) {
      EXPECT_LE(std::ranges::max(record.hits->work), budget.work);
    }
    if (record.status != Status::budget) continue;
    // What is left would not have paid for one more call and the returned point.
    const std::int64_t dearest = *std::ranges::max_element(record.prices);
    EXPECT_TRUE(record.summary.iterations == budget.iterations ||
                record.summary.work + dearest + 1 >= budget.work)
        << title_of(record) << " used " << record.summary.work;
  }
}

// Repeated runs: where two runs of one cell differ is named by the column of the curve. Perturbed
// starts differ in the last bit only, and their records are separate.

constexpr Real kUnit = std::numeric_limits<Real>::epsilon();

Request request_for(const std::string& problem) {
  Request request;
  request.problem.name = problem;
  return request;
}

TEST(Perturbation, MovesEachComponentByOneUnitInTheLastPlace) {
  const Vector start = Vector::LinSpaced(64, -3, 5);
  const Vector moved = perturbed_start(start, request_for("square"), 1);
  Index up = 0;
  for (Index i = 0; i < start.size(); ++i) {
    EXPECT_NE(moved[i], start[i]);
    EXPECT_EQ(std::nextafter(start[i], moved[i]), moved[i]) << "not its neighbour";
    up += moved[i] > start[i];
  }
  EXPECT_GT(up, 16) << "half of 64 random signs, give or take four deviations of 4";
  EXPECT_LT(up, 48);
}

TEST(Perturbation, GivesAZeroTheUnitOfTheLargestComponent) {
  Vector start(3);
  start << 0, -4, 1;
  EXPECT_EQ(std::abs(perturbed_start(start, request_for("square"), 1)[0]), 4 * kUnit);
  const Vector origin = perturbed_start(Vector::Zero(5), request_for("square"), 1);
  EXPECT_TRUE((origin.array().abs() == kUnit).all());
  EXPECT_EQ(perturbed_start(Vector(0), request_for("square"), 1).size(), 0);
}

TEST(Perturbation, IsTheSameForItsNumberAndAnotherForTheNext) {
  const Vector start = Vector::Ones(64);
  const Request square = request_for("square"), beale = request_for("beale");
  EXPECT_EQ(perturbed_start(start, square, 1), perturbed_start(start, square, 1));
  EXPECT_NE(perturbed_start(start, square, 1), perturbed_start(start, square, 2));
  EXPECT_NE(perturbed_start(start, square, 1), perturbed_start(start, beale, 1));
}

std::vector<Record> perturbed(const std::vector<Record>& records) {
  return perturbed_records(catalog(), records, 1, {.jobs = 2}).value();
}

FinishedMatrix small_matrix() {
  const Suite suite{.name = "small",
                    .title = "",
                    .blocks = {{.problems = {"rosenbrock"},
                                .optimizers = {"gd", "newton", "hig"},
                                .budget = {.iterations = 50}}}};
  return FinishedMatrix(catalog(), suite, Rates::builtin());
}

// At a rate of 1 the loss grows a thousandfold.
TEST(Rates, OfHalfInverseGradientsOnAUnetLowerItsLoss) {
  const auto block = [](const char* problem, const char* optimizer) -> MatrixBlock {
    return {.problems = {std::string(problem) + "[mode=learn,N=16,batch=4]"},
            .optimizers = {optimizer},
            .budget = {.iterations = 5, .target = 0}};
  };
  const Suite suite{.name = "unet",
                    .title = "",
                    .blocks = {block("poisson", "hig-damped"), block("heat", "hig")}};
  for (const Record& record : FinishedMatrix(catalog(), suite, Rates::builtin()).records)
    EXPECT_LT(record.summary.loss, record.summary.start_loss) << title_of(record);
}

TEST(PerturbedRuns, AnswerTheSameCellsFromAnotherStartAndLeaveTheRecordsAsTheyWere) {
  const FinishedMatrix matrix = small_matrix();
  const auto once = perturbed(matrix.records), again = perturbed(matrix.records);
  ASSERT_EQ(once.size(), matrix.records.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    const Record& record = matrix.records[i];
    EXPECT_EQ(once[i].cell, record.cell);
    EXPECT_EQ(once[i].summary.loss, again[i].summary.loss);
    EXPECT_NE(once[i].summary.start_loss, record.summary.start_loss) << title_of(record);
    EXPECT_NEAR(once[i].summary.start_loss, record.summary.start_loss,
                1e-12 * record.summary.start_loss);
    const auto kept = Store::find_in(matrix.folder.path(), matrix.requests[i]);
    ASSERT_TRUE(kept.has_value());
    EXPECT_EQ(kept->summary.start_loss, record.summary.start_loss);
    EXPECT_EQ(kept->repeat_wall_seconds, record.repeat_wall_seconds);
  }
}

TEST(PerturbedRuns, RefuseAnotherBuildAndLeaveOutWhatAClockEndedAndWhatDoesNotApply) {
  FinishedMatrix matrix = small_matrix();
  matrix.records[0].is_nondeterministic = true;
  matrix.records[1].status = Status::inapplicable;
  EXPECT_EQ(perturbed(matrix.records).size(), matrix.records.size() - 2);
  matrix.records[2].build = "0123456789abcdef";
  EXPECT_THROW(perturbed(matrix.records), UsageError);
}

// --- two records of one cell

Record run_of(const char* problem, const char* optimizer, std::int64_t iterations = 20) {
  const Request request = cell_of(problem, optimizer, {.iterations = iterations, .target = 0});
  return executed(catalog(), request);
}

TEST(SameResult, IsThatOfTheSameCellRunTwice) {
  const Record a = run_of("square", "gd[rate=1e-4]"), b = run_of("square", "gd[rate=1e-4]");
  EXPECT_TRUE(same_result(a, b));
  const Comparison found = compare_results(a, b);
  EXPECT_EQ(found.difference, "");
  EXPECT_EQ(found.iterations, 20);
}

TEST(SameResult, IsNotThatOfOneBitMoreAndTheEarliestIterationIsNamed) {
  const Record a = run_of("square", "gd[rate=1e-4]");
  Record b = a;
  b.curve.gradient_norm[5] = std::nextafter(b.curve.gradient_norm[5], 1e9);
  EXPECT_FALSE(same_result(a, b));
  EXPECT_TRUE(compare_results(a, b).difference.starts_with("gradient norm at iteration 5: "))
      << compare_results(a, b).difference;
  b.curve.loss[9] = 1;
  b.curve.work[4] = 7;
  EXPECT_TRUE(compare_results(a, b).difference.starts_with("work at iteration 4: "))
      << compare_results(a, b).difference;
}

TEST(SameResult, NotANumberIsItself) {
  Record a = run_of("square", "newton");
  a.curve.x_error[1] = std::nan("");
  EXPECT_EQ(compare_results(a, a).difference, "");
  Record b = a;
  b.curve.x_error[1] = 0;
  EXPECT_TRUE(compare_results(a, b).difference.ends_with(" 1: \"nan\" against 0.0"));
}

TEST(SameResult, ALongerRunDiffersUnlessAClockEndedOne) {
  const Record a = run_of("square", "gd[rate=1e-4]", 20);
  Record b = run_of("square", "gd[rate=1e-4]", 10);
  EXPECT_EQ(compare_results(a, b).difference, "last iteration: 20 against 10");
  b.is_nondeterministic = true;
  const Comparison found = compare_results(a, b);
  EXPECT_EQ(found.difference, "");
  EXPECT_EQ(found.iterations, 9);
  EXPECT_TRUE(found.is_up_to_there);
}

TEST(SameResult, TimesAndTheMachineAreNoDifference) {
  const Record a = run_of("square", "newton");
  Record b = a;
  b.summary.wall_seconds = 7;
  b.curve.wall_seconds[1] = 3;
  b.repeat_wall_seconds = {1, 2};
  b.provenance.run.command = "another";
  EXPECT_EQ(compare_results(a, b).difference, "");
  b.message = "another";
  EXPECT_EQ(compare_results(a, b).difference, "message: \"\" against \"another\"");
}

// Suite `notebook` end to end, read back from the records it leaves; what the notebook prints are
// claims, which PapersPage judges. Origin of the values: the end points of Fig. 1 of Holl, Koltun,
// Thuerey (2022), recomputed from the published script (1e-6).

const FinishedMatrix& notebook_matrix() {
  static const FinishedMatrix all(catalog(), cells_of("notebook"));
  return all;
}

// The record of `square` with an optimizer, one option at a value.
Record record_of(const std::string& optimizer, const std::string& option, Real value,
                 const std::string& inverse = "") {
  for (const Record& record : notebook_matrix().records) {
    const Component& used = record.request.optimizer;
    if (record.request.problem.name != "square" || used.name != optimizer) continue;
    if (std::abs(used.options.number(option, NAN) - value) > 1e-15) continue;
    if (inverse.empty() || used.options.text("inverse") == inverse) return record;
  }
  ADD_FAILURE() << "the suite has no " << optimizer << "[" << option << "=" << value << "]";
  return {};
}

void expect_end(const Record& record, std::int64_t steps, Real x1, Real x2) {
  EXPECT_EQ(record.summary.iterations, steps) << title_of(record);
  const std::vector<Real>& end = record.trajectory.value().x.back();
  EXPECT_NEAR(end[0], x1, 1e-6) << title_of(record);
  EXPECT_NEAR(end[1], x2, 1e-6) << title_of(record);
}

TEST(Figure1Suite, CirclesAndLinesEndWhereTheScriptEndsThem) {
  expect_end(record_of("gd", "rate", 0.5 / 36), 10, 2.263480, 0.801555);
  expect_end(record_of("newton", "rate", 0.5), 10, 0.00292969, 0.484517);
  expect_end(record_of("gd", "rate", 0.005), 1000, 1.295e-4, 0.157537);
  expect_end(record_of("newton", "rate", 0.1), 100, 7.97e-5, 0.101110);
  expect_end(record_of("sip", "step", 0.05, "analytic"), 100, 0.0177616, 0.230835);
  // By the formula: physics inversion is (x1 (1 − η), x2 √(1 − η)), the inverse gradient
  // (x1 (1 − η), x2 (1 − η/2)) a step; the figure prints no figures of these.
  const Real halved = 3 * std::pow(0.5, 10);
  expect_end(record_of("sip", "step", 0.5, "analytic"), 10, halved, 3 * std::pow(0.5, 5));
  expect_end(record_of("inverse-gradient", "rate", 0.5), 10, halved, 3 * std::pow(0.75, 10));
}

TEST(Figure5aSuite, KeepsThePathsOfTheSine) {
  std::size_t count = 0;
  for (const Record& record : notebook_matrix().records) {
    if (record.request.problem.spec != "sine[xi=1,phi=15]") continue;
    EXPECT_EQ(record.trajectory.value().x.size(), record.curve.iteration.size());
    ++count;
  }
  EXPECT_EQ(count, 7U);  // the six methods of the figure, and the update that vanishes
}

}  // namespace
}  // namespace isoline::benchmarks
