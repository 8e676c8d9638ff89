// Component metadata, plans, and the measured costs of oracles.
#include "benchmarks/run/sheets.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "benchmarks/run/run_plan.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {

using problems::Draw;
using problems::Problem;
using problems::problem_entry;
using problems::ProblemParts;
namespace {

Sheet sheet_of(const std::string& problem, const OptionValues& options) {
  return problem_sheet(catalog(), complete_problem(catalog(), problem, options));
}

TEST(Sheets, OfADirectProblemTellTheConditionNumbersOfItsJacobian) {
  const Sheet scaling = sheet_of("scaling", {{"alpha", 0.02}}), square = sheet_of("square", {});
  EXPECT_NEAR(scaling.condition.value(), 50, 50e-12);
  EXPECT_NEAR(scaling.start_condition.value(), 50, 50e-12);
  EXPECT_EQ(sheet_from_json(to_json(scaling)).condition, scaling.condition);
  // λ_pq = −4 [sin²(πp/2(N+1)) + sin²(πq/2(N+1))]: their extremes are those of one direction.
  const Real poisson = std::pow(std::tan(std::numbers::pi / 18), -2);
  EXPECT_NEAR(sheet_of("poisson", {{"N", 8}}).condition.value(), poisson, 1e-10 * poisson);
  // J of (x₁, x₂²) is diag(1, 2x₂), `square` starts at (3, 3), and J lacks rank at its solution 0.
  EXPECT_NEAR(square.start_condition.value(), 6, 1e-14);
  EXPECT_EQ(sheet_from_json(to_json(square)).start_condition, square.start_condition);
  EXPECT_TRUE(std::isinf(square.condition.value()));
  const Sheet brown_dennis = sheet_of("brown-dennis", {});
  EXPECT_TRUE(brown_dennis.start_condition);
  EXPECT_EQ(brown_dennis.condition.has_value(), !brown_dennis.truth.empty());
  for (const Sheet& none :  // what is learned or too large
       {sheet_of("sine", {{"mode", "learn"}, {"batch", 4}}), sheet_of("poisson", {{"N", 64}})})
    EXPECT_FALSE(none.condition || none.start_condition) << none.spec;
}

// y = x, but for a pole at one point of the landscape, or a fault.
struct PoleOptions {
  std::string fault = "infinite";
};
void fields(PoleOptions& o, auto& field) {
  field("fault", o.fault, Choices{"infinite", "nan", "throw", "exit", "crash"},
        "what happens at the origin");
}

ProblemParts make_pole(const PoleOptions& o, const Draw&) {
  const auto value = [fault = o.fault](VectorRef x) -> Vector {
    if (x.squaredNorm() > 0) return x;
    if (fault == "throw") throw std::runtime_error("no value at the pole");
    if (fault == "exit") std::_Exit(0);
    if (fault == "crash") std::raise(SIGKILL);
    return Eigen::Vector2d(fault == "nan" ? std::nan("") : INFINITY, 0);
  };
  return {
      .physics = physics_of(2, 2, value, [](VectorRef) { return Matrix::Identity(2, 2).eval(); }),
      .start = Vector(Eigen::Vector2d(3, 1)),
      .target = Eigen::Vector2d(2, 2),
      .minimum = 0,
      .window = std::array<Real, 4>{-4, 4, -4, 4}};
}

Catalog with_pole() {
  Catalog catalog = builtin_catalog();
  catalog.problems.add(problem_entry({.name = "pole", .title = "Has a pole"}, make_pole));
  return catalog;
}

// The origin is the 41st of 81 points of each side.
TEST(Sheets, ALandscapeWithAPoleIsBoundedByItsFiniteValues) {
  const Catalog catalog = with_pole();
  for (const char* fault : {"infinite", "nan"}) {
    const Sheet sheet =
        problem_sheet(catalog, complete_problem(catalog, "pole", {{"fault", fault}}));
    EXPECT_FALSE(std::isfinite(sheet.landscape_x->loss(40, 40)));
    EXPECT_EQ(sheet.landscape_y->window, (std::array<Real, 4>{-4, 4, -4, 4}));
    for (const Real loss : sheet.landscape_y->loss.values()) EXPECT_TRUE(std::isfinite(loss));
    EXPECT_EQ(sheet_from_json(to_json(sheet)).landscape_y->window, sheet.landscape_y->window);
  }
}

TEST(Sheets, ThatCannotBeMadeCostTheirFiguresAndNotTheRun) {
  const Catalog catalog = with_pole();
  for (const char* fault : {"infinite", "nan", "throw", "crash", "exit"}) {
    const TemporaryFolder folder;
    const Request request = named({.problem = complete_problem(catalog, "pole", {{"fault", fault}}),
                                   .optimizer = complete_optimizer(catalog, "gd", {{"rate", 0.1}}),
                                   .budget = {.iterations = 5}});
    const Outcome outcome = run_plan(catalog, "pole", {request}, folder.path(), {});
    EXPECT_EQ(outcome.statuses.at(Status::budget), 1) << fault;
    const bool is_whole = fault == std::string("infinite") || fault == std::string("nan");
    EXPECT_EQ(outcome.remarks.size(), is_whole ? 0U : 1U) << fault;
    Sheet sheet = described_problem(catalog, request.problem);
    const std::filesystem::path file = folder.path() / "components" / sheet.file_name();
    sheet = sheet_from_text(read_text(file), file.string());
    EXPECT_EQ(sheet.title, "Has a pole") << fault;
    EXPECT_EQ(sheet.landscape_x.has_value(), is_whole) << fault;
  }
}

TEST(Sheets, OfEveryComponentConformToTheSchema) {
  const Json form = schema("component");
  const auto expect_sound = [&](const Sheet& sheet) {
    const Json json = to_json(sheet);
    EXPECT_EQ(schema_violations(json, form), std::vector<std::string>{}) << sheet.name;
    EXPECT_EQ(to_json(sheet_from_json(json)), json) << sheet.name;
  };
  for (const std::string& name : catalog().problems.ready().names())
    expect_sound(sheet_of(name, {}));
  for (const std::string& name : catalog().optimizers.ready().names())
    expect_sound(optimizer_sheet(catalog(), complete_optimizer(catalog(), name, OptionValues())));
}

TEST(Plans, ConformToTheSchemaAndKeepEarlierCells) {
  const TemporaryFolder folder;
  Store store(folder.path());
  store.plan("one", {{"0123456789abcdef", "twist", "gd", 0}});
  store.plan("two",
             {{"0123456789abcdef", "twist", "gd", 0}, {"fedcba9876543210", "twist", "sip", 0}});
  const Json plan = read_json(folder.path() / "plan.json");
  EXPECT_EQ(schema_violations(plan, schema("plan")), std::vector<std::string>{});
  EXPECT_EQ(plan.at("cells").size(), 2U);
  EXPECT_EQ(plan.at("suites").size(), 2U);
}

// --- Measured prices: every oracle offered, in the right order of magnitude, kept by later runs.

Request request_of(const std::string& problem, const OptionValues& options) {
  return named({.problem = complete_problem(catalog(), problem, options),
                .optimizer = complete_optimizer(catalog(), "gd", OptionValues())});
}

MeasuredPrices prices_of(const std::string& name, const OptionValues& options) {
  const Component component = complete_problem(catalog(), name, options);
  return measure_prices(make_problem(catalog(), component, 0), "b");
}

const MeasuredPrice* find(const MeasuredPrices& prices, std::string_view oracle) {
  const auto at = std::ranges::find(prices.oracles, oracle, &MeasuredPrice::oracle);
  return at == prices.oracles.end() ? nullptr : &*at;
}

TEST(Prices, AreMeasuredOfEveryOracleThatIsOffered) {
  for (const auto& [name, options] : std::vector<std::pair<std::string, OptionValues>>{
           {"rosenbrock", {}},
           {"poisson", {{"N", 8}}},
           {"sine", {{"mode", "learn"}, {"batch", 4}}}}) {
    const Problem problem = make_problem(catalog(), request_of(name, options).problem, 0);
    const MeasuredPrices measured = measure_prices(problem, "b");
    EXPECT_GT(measured.forward_seconds, 0) << name;
    const OracleSet offered = problem.offers();
    for (std::size_t kind = 0; kind < kOracles; ++kind) {
      const MeasuredPrice* const at = find(measured, kOracleNames[kind]);
      const auto oracle = static_cast<Oracle>(kind);
      const bool is_measured = offered.contains(oracle) && oracle != Oracle::truth;
      ASSERT_EQ(at != nullptr, is_measured) << name << ", " << kOracleNames[kind];
      if (!is_measured) continue;
      EXPECT_EQ(at->declared, problem.prices()[kind]) << name << ", " << at->oracle;
      EXPECT_LE(at->low, at->price) << name << ", " << at->oracle;
      EXPECT_LE(at->price, at->high) << name << ", " << at->oracle;
      EXPECT_GE(at->calls, at->rounds) << name << ", " << at->oracle;
      EXPECT_GT(at->rounds, 0) << name << ", " << at->oracle;
    }
    EXPECT_EQ(measured.oracles[0].price, 1) << name;
  }
}

// A network sees one pass of a batch, shared by its samples; the solve has physics besides.
TEST(Prices, OfALearnedProblemTellWhatItsNetworkTakesAnExample) {
  EXPECT_FALSE(find(prices_of("sine", {}), kInference));
  const MeasuredPrices learned = prices_of("sine", {{"mode", "learn"}, {"batch", 100}});
  const MeasuredPrice* const price = find(learned, kInference);
  ASSERT_TRUE(price);
  EXPECT_GT(price->price, 0);
  EXPECT_LT(price->price, 0.1) << "a hundredth of a batch, or a few of them";
  EXPECT_EQ(price->declared, 0);
}

TEST(Prices, OfMatricesAreLeftOutWhereOneWouldTakeTooLong) {
  const MeasuredPrices measured = prices_of("poisson", {{"N", 64}});  // a Jacobian of 128 MiB
  for (const char* product : {"pullback", "pushforward", "hessian_product", "inverse"})
    EXPECT_TRUE(find(measured, product)) << product;
  for (const char* matrix : {"jacobian", "hessian", "curvature", "sensitivity"})
    EXPECT_FALSE(find(measured, matrix)) << matrix;
}

// Of y = x after so many additions forward, and so many back.
MeasuredPrice pullback_price(int forward, int back) {
  const auto labour = [](Real value, int additions) {
    volatile Real sum = value;
    for (int i = 0; i < additions; ++i) sum = sum + 0;
    return Matrix::Constant(1, 1, Real{sum}).eval();
  };
  const Problem problem(
      {.physics = physics_of(
           1, 1, [=](VectorRef x) -> Vector { return labour(x[0], forward).col(0); },
           [=](VectorRef) { return labour(1, back); }),
       .start = Vector::Ones(1),
       .target = Vector::Zero(1)});
  return *find(measure_prices(problem, "b"), "pullback");
}

// Both are measured side by side, so that a busy machine slows them alike: 20 within a factor of 4.
// A difference of two times would be lost in what they vary by.
TEST(Prices, AreInForwardSolvesAndNeverZeroWhereACallIsShortBesideOne) {
  const MeasuredPrice dear = pullback_price(2000, 40'000), cheap = pullback_price(200'000, 200);
  EXPECT_GT(dear.price, 5);
  EXPECT_LT(dear.price, 80);
  EXPECT_GT(cheap.low, 0);
  EXPECT_LT(cheap.price, 0.1);
}

TEST(Prices, BelowAMicrosecondAForwardSolveOrWithoutAnAgreedRangeAreNotResolvedAndTheSheetTells) {
  const auto is_sound = [](Real low, Real price, Real high, double forward_seconds) {
    return is_resolved({.oracle = "pullback", .price = price, .low = low, .high = high},
                       forward_seconds);
  };
  EXPECT_TRUE(is_sound(1, 1.5, 2, 1e-5));
  EXPECT_FALSE(is_sound(1, 1.5, 2, 1e-7));
  EXPECT_FALSE(is_sound(0, 0, 0.1, 1e-5));
  EXPECT_FALSE(is_sound(0.1, 1, 2, 1e-5));
  Sheet sheet;
  sheet.options_text = "[]";
  sheet.prices = MeasuredPrices{.build = "b", .processor = "p", .forward_seconds = 1e-8};
  sheet.prices->oracles = {{.oracle = "pullback", .rounds = 1, .calls = 1, .resolved = false}};
  Json json = to_json(sheet);
  EXPECT_FALSE(sheet_from_json(json).prices->oracles[0].resolved);
  json["prices"]["oracles"][0].erase("resolved");  // an older sheet
  EXPECT_TRUE(sheet_from_json(json).prices->oracles[0].resolved);
}

TEST(Prices, StandInTheSheetAndAreKeptByLaterRuns) {
  const TemporaryFolder folder;
  Store store(folder.path());
  const Request request = request_of("rosenbrock", {});
  const auto written = [&] {
    write_sheets(catalog(), {request}, store);
    const Sheet sheet = problem_sheet(catalog(), request.problem);
    return read_json(folder.path() / "components" / sheet.file_name());
  };
  Json first = written();
  ASSERT_TRUE(first.contains("prices"));
  EXPECT_EQ(schema_violations(first, schema("component")), std::vector<std::string>{});
  EXPECT_EQ(to_json(sheet_from_json(first)), first);
  EXPECT_EQ(written(), first);
  first["prices"]["build"] = "another";  // then they are measured again
  const Sheet other = sheet_from_json(first);
  store.write(other);
  EXPECT_NE(written().at("prices").at("build"), "another");
}

}  // namespace
}  // namespace isoline::benchmarks
