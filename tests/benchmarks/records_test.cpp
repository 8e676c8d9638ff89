// What every record must hold, over every problem with every optimizer.
#include <cmath>
#include <numeric>

#include "benchmarks/plan/catalog.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"

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

}  // namespace
}  // namespace isoline::benchmarks
