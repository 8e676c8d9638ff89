// Suite `notebook` end to end, read back from the records it leaves. Origin of the values: the
// table printed by the comparison notebook of the Physics-based Deep Learning book (single
// precision: 1e-5), and the end points of Fig. 1 of Holl, Koltun, Thuerey (2022), recomputed from
// the published script (1e-6).
#include <cmath>

#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {
namespace {

const FinishedMatrix& notebook() {
  static const FinishedMatrix all(catalog(), cells_of("notebook"));
  return all;
}

// The record of `square` with an optimizer, one option at a value.
Record record_of(const std::string& optimizer, const std::string& option, Real value,
                 const std::string& inverse = "") {
  for (const Record& record : notebook().records) {
    const Component& used = record.request.optimizer;
    if (record.request.problem.name != "square" || used.name != optimizer) continue;
    if (std::abs(used.options.number(option, NAN) - value) > 1e-15) continue;
    if (inverse.empty() || used.options.text("inverse") == inverse) return record;
  }
  ADD_FAILURE() << "the suite has no " << optimizer << "[" << option << "=" << value << "]";
  return {};
}

// x1 and x2 after each step.
void expect_iterates(const Record& record, const std::vector<Real>& printed) {
  ASSERT_TRUE(record.trajectory.has_value());
  const std::vector<std::vector<Real>>& x = record.trajectory->x;
  ASSERT_EQ(2 * x.size(), printed.size() + 2) << title_of(record);
  EXPECT_EQ(x[0], (std::vector<Real>{3, 3}));
  for (std::size_t i = 0; i < printed.size(); ++i)
    EXPECT_NEAR(x[i / 2 + 1][i % 2], printed[i], 1e-5) << title_of(record) << ", number " << i;
}

TEST(NotebookSuite, EachMethodTakesItsTenStepsAsPrinted) {
  expect_iterates(record_of("gd", "rate", 0.01),
                  {2.94,      1.9200001, 2.8812,    1.6368846, 2.823576,  1.4614503, 2.7671044,
                   1.3365935, 2.7117622, 1.2410815, 2.657527,  1.1646168, 2.6043763, 1.1014326,
                   2.5522888, 1.0479842, 2.501243,  1.0019454, 2.4512184, 0.96171147});
  expect_iterates(
      record_of("newton", "rate", 1.0 / 3),
      {2.0,       2.6666667,  1.3333333,  2.3703704,  0.88888884, 2.1069958,  0.59259254,
       1.8728852, 0.39506167, 1.6647868,  0.26337445, 1.4798105,  0.17558296, 1.315387,
       0.1170553, 1.1692328,  0.07803687, 1.0393181,  0.05202458, 0.92383826});
  expect_iterates(
      record_of("sip", "step", 0.3, "analytic"),
      {2.1,        2.5099802, 1.4699999,  2.1000001,  1.0289999,  1.7569861,  0.72029996,
       1.47,       0.50421,   1.2298902,  0.352947,   1.029,      0.24706289, 0.86092323,
       0.17294402, 0.7203,    0.12106082, 0.60264623, 0.08474258, 0.50421});
  expect_iterates(
      record_of("sip", "step", 0.3, "lbfgs"),
      {2.09999967, 2.50998022, 1.46999859, 2.10000011, 1.02899871, 1.75698602, 0.72029824,
       1.4699998,  0.50420733, 1.22988982, 0.35294448, 1.02899957, 0.24705997, 0.86092355,
       0.17294205, 0.72030026, 0.12106103, 0.60264817, 0.08474171, 0.50421247});
}

// Of the first update with the diagonal, toward the origin; at most √2.
Real alignment(const Record& record) {
  const std::vector<std::vector<Real>>& x = record.trajectory.value().x;
  const Real d1 = x.at(0)[0] - x.at(1)[0], d2 = x.at(0)[1] - x.at(1)[1];
  return (d1 + d2) / std::hypot(d1, d2);
}

TEST(NotebookSuite, FirstUpdatesAlignWithTheDiagonalAsPrinted) {
  constexpr Real kPrinted = 1e-6;
  EXPECT_NEAR(alignment(record_of("gd", "rate", 0.01)), 1.053930, kPrinted);
  EXPECT_NEAR(alignment(record_of("newton", "rate", 1.0 / 3)), 1.264911, kPrinted);
  EXPECT_NEAR(alignment(record_of("sip", "step", 0.3, "analytic")), 1.356443, kPrinted);
  EXPECT_NEAR(alignment(record_of("sip", "step", 0.3, "lbfgs")), 1.356443, kPrinted);
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

// A straight ray to the origin of y space: y1 and y2 shrink by one factor.
TEST(Figure1Suite, PhysicsInversionIsAStraightRayInY) {
  const Record record = record_of("sip", "step", 0.05, "analytic");
  for (const std::vector<Real>& y : record.trajectory.value().y)
    EXPECT_NEAR(y[1], 3 * y[0], 1e-12);  // rounding of a hundred steps
}

TEST(Figure5aSuite, KeepsThePathsOfTheSine) {
  std::size_t count = 0;
  for (const Record& record : notebook().records) {
    if (record.request.problem.name != "sine") continue;
    EXPECT_EQ(record.trajectory.value().x.size(), record.curve.iteration.size());
    ++count;
  }
  EXPECT_EQ(count, 7U);  // the six methods of the figure, and the update that vanishes
}

}  // namespace
}  // namespace isoline::benchmarks
