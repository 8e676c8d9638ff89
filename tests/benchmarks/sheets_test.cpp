// Sheets of problems: how ill-conditioned each is, where that can be told.
#include "benchmarks/run/sheets.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>

#include "benchmarks/run/run_plan.h"
#include "core/files.h"
#include "optimizers/optimizer.h"
#include "problems/dense_physics.h"
#include "problems/problem.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using problems::DensePhysics;
using problems::Draw;
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

}  // namespace
}  // namespace isoline::benchmarks
