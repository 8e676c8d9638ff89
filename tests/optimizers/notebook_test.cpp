// The comparison notebook of the Physics-based Deep Learning book and Fig. 1 of Holl, Koltun,
// Thuerey (2022), on `square`. Origin of the values: the notebook's printed table (single
// precision: 1e-5); the end points of Fig. 1, recomputed from the published script (1e-6).
#include <gtest/gtest.h>

#include "run.h"

namespace isoline {
namespace {

Problem square() {
  ProblemRegistry problems("problem");
  register_problems(problems);
  return problems.at("square").make(Json::object(), Draw(0, "square"));
}

using Table = Eigen::Matrix<Real, 10, 2>;

void expect_path(const std::string& spec, const Table& table) {
  const Outcome result = run(square(), spec, iterations(table.rows()));
  ASSERT_EQ(result.path.size(), table.rows()) << spec;
  for (Index i = 0; i < table.rows(); ++i)
    EXPECT_LE((result.path[i].transpose() - table.row(i)).cwiseAbs().maxCoeff(), 1e-5)
        << spec << ", iteration " << i;
}

TEST(Notebook, GradientDescentTakesItsTenSteps) {
  expect_path("gd[rate=0.01]", Table{{2.94, 1.9200001},
                                     {2.8812, 1.6368846},
                                     {2.823576, 1.4614503},
                                     {2.7671044, 1.3365935},
                                     {2.7117622, 1.2410815},
                                     {2.657527, 1.1646168},
                                     {2.6043763, 1.1014326},
                                     {2.5522888, 1.0479842},
                                     {2.501243, 1.0019454},
                                     {2.4512184, 0.96171147}});
}

TEST(Notebook, NewtonTakesItsTenSteps) {
  expect_path("newton[rate=0.33333333333333333]", Table{{2.0, 2.6666667},
                                                        {1.3333333, 2.3703704},
                                                        {0.88888884, 2.1069958},
                                                        {0.59259254, 1.8728852},
                                                        {0.39506167, 1.6647868},
                                                        {0.26337445, 1.4798105},
                                                        {0.17558296, 1.315387},
                                                        {0.1170553, 1.1692328},
                                                        {0.07803687, 1.0393181},
                                                        {0.05202458, 0.92383826}});
}

TEST(Notebook, PhysicsInversionTakesItsTenStepsByEitherInverse) {
  const Table analytic{{2.1, 2.5099802},         {1.4699999, 2.1000001}, {1.0289999, 1.7569861},
                       {0.72029996, 1.47},       {0.50421, 1.2298902},   {0.352947, 1.029},
                       {0.24706289, 0.86092323}, {0.17294402, 0.7203},   {0.12106082, 0.60264623},
                       {0.08474258, 0.50421}};
  const Table numerical{{2.09999967, 2.50998022}, {1.46999859, 2.10000011},
                        {1.02899871, 1.75698602}, {0.72029824, 1.4699998},
                        {0.50420733, 1.22988982}, {0.35294448, 1.02899957},
                        {0.24705997, 0.86092355}, {0.17294205, 0.72030026},
                        {0.12106103, 0.60264817}, {0.08474171, 0.50421247}};
  expect_path("sip[step=0.3]", analytic);
  expect_path("sip[step=0.3,inverse=analytic]", analytic);
  expect_path("sip[step=0.3,inverse=lbfgs]", analytic);
  expect_path("sip[step=0.3,inverse=lbfgs]", numerical);
}

TEST(Notebook, FirstUpdatesAlignWithTheDiagonalAsPrinted) {
  const auto alignment = [](const std::string& spec) {
    const Vector update = run(square(), spec, iterations(1)).theta - Eigen::Vector2d(3, 3);
    return -update.normalized().sum();  // the printed figure is toward the origin
  };
  constexpr Real kPrinted = 1e-6;
  EXPECT_NEAR(alignment("gd[rate=0.01]"), 1.053930, kPrinted);
  EXPECT_NEAR(alignment("newton[rate=0.33333333333333333]"), 1.264911, kPrinted);
  EXPECT_NEAR(alignment("sip[step=0.3]"), 1.356443, kPrinted);
}

TEST(Figure1, CurvesEndWhereTheScriptEndsThem) {
  const auto expect_end = [](const std::string& spec, int steps, Real x1, Real x2) {
    const Outcome result = run(square(), spec, iterations(steps));
    EXPECT_NEAR(result.theta[0], x1, 1e-6) << spec;
    EXPECT_NEAR(result.theta[1], x2, 1e-6) << spec;
  };
  expect_end("gd[rate=0.01388888888888889]", 10, 2.263480, 0.801555);
  expect_end("newton[rate=0.5]", 10, 0.00292969, 0.484517);
  expect_end("gd[rate=0.005]", 1000, 1.295e-4, 0.157537);
  expect_end("newton[rate=0.1]", 100, 7.97e-5, 0.101110);
  expect_end("sip[step=0.05]", 100, 0.0177616, 0.230835);
}

}  // namespace
}  // namespace isoline
