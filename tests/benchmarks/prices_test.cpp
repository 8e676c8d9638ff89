// Measured prices: every oracle offered, in the right order of magnitude, kept by later runs.
#include "benchmarks/run/prices.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "benchmarks/plan/resources.h"
#include "benchmarks/run/sheets.h"
#include "core/json.h"
#include "core/records/schema.h"
#include "problems/dense_physics.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using problems::DensePhysics;
using problems::Problem;
namespace {

const Catalog& catalog() {
  static const Catalog all = builtin_catalog();
  return all;
}

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

// y = x after so many additions forward, and twenty times as many back.
class Laborious final : public DensePhysics {
 public:
  Laborious() : DensePhysics(1, 1) {}
  void value(VectorRef x, VectorOut y) const override { y[0] = x[0] + labour(kForward); }
  void derivative(VectorRef, BatchOut J) const override { J(0, 0) = 1 + labour(20 * kForward); }

 private:
  static constexpr int kForward = 2000;
  static Real labour(int additions) {
    volatile Real sum = 0;
    for (int i = 0; i < additions; ++i) sum = sum + 0;
    return sum;
  }
};

// Both are measured side by side, so that a busy machine slows them alike: 20 within a factor of 4.
TEST(Prices, AreInForwardSolves) {
  const Problem problem({.physics = std::make_unique<Laborious>(),
                         .start = Vector::Ones(1),
                         .target = Vector::Zero(1)});
  const MeasuredPrices measured = measure_prices(problem, "b");
  const auto pullback = std::ranges::find(measured.oracles, "pullback", &MeasuredPrice::oracle);
  ASSERT_NE(pullback, measured.oracles.end());
  EXPECT_GT(pullback->price, 5);
  EXPECT_LT(pullback->price, 80);
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
