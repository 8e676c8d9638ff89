// Sheets of problems: how ill-conditioned each is, where that can be told.
#include "benchmarks/run/sheets.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/run_plan.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "optimizers/optimizer.h"
#include "problems/dense_physics.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using problems::DensePhysics;
using problems::Draw;
using problems::Problem;
using problems::problem_entry;
using problems::ProblemParts;
namespace {

Sheet sheet_of(const std::string& problem, const OptionValues& options) {
  static const Catalog catalog = builtin_catalog();
  return problem_sheet(catalog, complete_problem(catalog, problem, options));
}

TEST(Sheets, OfADirectProblemTellTheConditionNumberOfItsJacobian) {
  const Sheet scaling = sheet_of("scaling", {{"alpha", 0.02}});
  EXPECT_NEAR(scaling.condition.value(), 50, 50e-12);
  EXPECT_EQ(sheet_from_json(to_json(scaling)).condition, scaling.condition);
  // λ_pq = −4 [sin²(πp/2(N+1)) + sin²(πq/2(N+1))]: their extremes are those of one direction.
  const Real angle = std::numbers::pi / 18;
  const Real poisson = std::pow(std::tan(angle), -2);
  EXPECT_NEAR(sheet_of("poisson", {{"N", 8}}).condition.value(), poisson, 1e-10 * poisson);
}

// J of (x₁, x₂²) is diag(1, 2x₂), and `square` starts at (3, 3).
TEST(Sheets, OfADirectProblemTellTheConditionNumberAtTheStartBesidesThatAtTheSolution) {
  const Sheet square = sheet_of("square", {});
  EXPECT_NEAR(square.start_condition.value(), 6, 1e-14);
  EXPECT_EQ(sheet_from_json(to_json(square)).start_condition, square.start_condition);
  EXPECT_NEAR(sheet_of("scaling", {{"alpha", 0.02}}).start_condition.value(), 50, 50e-12);
  const Sheet brown_dennis = sheet_of("brown-dennis", {});
  EXPECT_TRUE(brown_dennis.start_condition);
  EXPECT_EQ(brown_dennis.condition.has_value(), !brown_dennis.truth.empty());
}

// At the solution (0, 0) of `square`, x₂² has no slope: J lacks rank there.
TEST(Sheets, OfAProblemThatLacksRankAtItsSolutionSaySo) {
  EXPECT_TRUE(std::isinf(sheet_of("square", {}).condition.value()));
}

TEST(Sheets, TellNoConditionNumberOfWhatIsLearnedOrTooLarge) {
  for (const Sheet& sheet :
       {sheet_of("sine", {{"mode", "learn"}, {"batch", 4}}), sheet_of("poisson", {{"N", 64}})}) {
    EXPECT_FALSE(sheet.condition) << sheet.spec;
    EXPECT_FALSE(sheet.start_condition) << sheet.spec;
  }
}

// y = x, but for a pole at one point of the landscape, or a fault.
class Pole final : public DensePhysics {
 public:
  explicit Pole(std::string fault) : DensePhysics(2, 2), fault_(std::move(fault)) {}
  void value(VectorRef x, VectorOut y) const override {
    y = x;
    if (x.squaredNorm() > 0) return;
    if (fault_ == "throw") throw std::runtime_error("no value at the pole");
    if (fault_ == "exit") std::_Exit(0);
    if (fault_ == "crash") std::raise(SIGKILL);
    y[0] = fault_ == "nan" ? std::nan("") : std::numeric_limits<Real>::infinity();
  }
  void derivative(VectorRef, BatchOut J) const override { J.setIdentity(); }

 private:
  std::string fault_;
};

struct PoleOptions {
  std::string fault = "infinite";
};
void fields(PoleOptions& o, auto& field) {
  field("fault", o.fault, Choices{"infinite", "nan", "throw", "exit", "crash"},
        "what happens at the origin");
}

ProblemParts make_pole(const PoleOptions& o, const Draw&) {
  return {.physics = std::make_unique<Pole>(o.fault),
          .start = Vector(Eigen::Vector2d(3, 1)),
          .target = Eigen::Vector2d(2, 2),
          .minimum = 0,
          .window = std::array<Real, 4>{-4, 4, -4, 4}};
}

Catalog with_pole() {
  Catalog catalog = builtin_catalog();
  catalog.problems.add(problem_entry(
      {.name = "pole", .title = "Has a pole", .formula = "y = x", .source = "here"}, make_pole));
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

// --- Measured prices: every oracle offered, in the right order of magnitude, kept by later runs.

Request request_of(const std::string& problem, const OptionValues& options) {
  return named({.problem = complete_problem(catalog(), problem, options),
                .optimizer = complete_optimizer(catalog(), "gd", OptionValues())});
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
      const auto at =
          std::ranges::find(measured.oracles, kOracleNames[kind], &MeasuredPrice::oracle);
      const auto oracle = static_cast<Oracle>(kind);
      const bool is_measured = offered.contains(oracle) && oracle != Oracle::truth;
      ASSERT_EQ(at != measured.oracles.end(), is_measured) << name << ", " << kOracleNames[kind];
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
  const auto inference = [](const std::string& name, const OptionValues& options) {
    const Problem problem = make_problem(catalog(), request_of(name, options).problem, 0);
    const MeasuredPrices measured = measure_prices(problem, "b");
    const auto at = std::ranges::find(measured.oracles, kInference, &MeasuredPrice::oracle);
    return at == measured.oracles.end() ? std::optional<MeasuredPrice>() : *at;
  };
  EXPECT_FALSE(inference("sine", {}));
  const auto price = inference("sine", {{"mode", "learn"}, {"batch", 100}});
  ASSERT_TRUE(price);
  EXPECT_GT(price->price, 0);
  EXPECT_LT(price->price, 0.1) << "a hundredth of a batch, or a few of them";
  EXPECT_EQ(price->declared, 0);
}

TEST(Prices, OfMatricesAreLeftOutWhereOneWouldTakeTooLong) {
  const OptionValues grid{{"N", 64}};  // 4096 unknowns: a Jacobian of 128 MiB
  const Problem problem = make_problem(catalog(), request_of("poisson", grid).problem, 0);
  const MeasuredPrices measured = measure_prices(problem, "b");
  const auto has = [&](const char* oracle) {
    return std::ranges::find(measured.oracles, oracle, &MeasuredPrice::oracle) !=
           measured.oracles.end();
  };
  for (const char* product : {"pullback", "pushforward", "hessian_product", "inverse"})
    EXPECT_TRUE(has(product)) << product;
  for (const char* matrix : {"jacobian", "hessian", "curvature", "sensitivity"})
    EXPECT_FALSE(has(matrix)) << matrix;
}

// y = x after so many additions forward, and so many back.
class Laborious final : public DensePhysics {
 public:
  Laborious(int forward, int back) : DensePhysics(1, 1), forward_(forward), back_(back) {}
  void value(VectorRef x, VectorOut y) const override { y[0] = x[0] + labour(forward_); }
  void derivative(VectorRef, BatchOut J) const override { J(0, 0) = 1 + labour(back_); }

 private:
  static Real labour(int additions) {
    volatile Real sum = 0;
    for (int i = 0; i < additions; ++i) sum = sum + 0;
    return sum;
  }
  int forward_, back_;
};

MeasuredPrice pullback_price(int forward, int back) {
  const Problem problem({.physics = std::make_unique<Laborious>(forward, back),
                         .start = Vector::Ones(1),
                         .target = Vector::Zero(1)});
  const MeasuredPrices measured = measure_prices(problem, "b");
  return *std::ranges::find(measured.oracles, "pullback", &MeasuredPrice::oracle);
}

// Both are measured side by side, so that a busy machine slows them alike: 20 within a factor of 4.
TEST(Prices, AreInForwardSolves) {
  const MeasuredPrice pullback = pullback_price(2000, 40'000);
  EXPECT_GT(pullback.price, 5);
  EXPECT_LT(pullback.price, 80);
}

// A difference of two times would be lost in what they vary by.
TEST(Prices, OfACallThatIsShortBesideTheForwardSolveAreNeverZero) {
  const MeasuredPrice pullback = pullback_price(200'000, 200);
  EXPECT_GT(pullback.low, 0);
  EXPECT_LT(pullback.price, 0.1);
}

TEST(Prices, BelowAMicrosecondAForwardSolveOrWithoutAnAgreedRangeAreNotResolved) {
  const auto is_sound = [](Real low, Real price, Real high, double forward_seconds) {
    return is_resolved({.oracle = "pullback", .price = price, .low = low, .high = high},
                       forward_seconds);
  };
  EXPECT_TRUE(is_sound(1, 1.5, 2, 1e-5));
  EXPECT_FALSE(is_sound(1, 1.5, 2, 1e-7));
  EXPECT_FALSE(is_sound(0, 0, 0.1, 1e-5));
  EXPECT_FALSE(is_sound(0.1, 1, 2, 1e-5));
}

TEST(Prices, TellInTheSheetWhetherTheyAreResolved) {
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
  const Json schema = parse_json(std::string(builtin_schemas().at("component")), "component");
  EXPECT_EQ(schema_violations(first, schema), std::vector<std::string>{});
  EXPECT_EQ(to_json(sheet_from_json(first)), first);
  EXPECT_EQ(written(), first);
  first["prices"]["build"] = "another";  // then they are measured anew
  const Sheet other = sheet_from_json(first);
  store.write(other);
  EXPECT_NE(written().at("prices").at("build"), "another");
}

}  // namespace
}  // namespace isoline::benchmarks
