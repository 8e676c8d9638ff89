// A problem and an optimizer that somebody else wrote, added to the catalog and nothing else: they
// are covered everywhere by being there.
#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/preview.h"
#include "benchmarks/run/sheets.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "optimizers/optimizer.h"
#include "problems/dense_physics.h"
#include "problems/problem.h"
#include "reports/report.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {

using optimizers::rule_entry;
using problems::DensePhysics;
using problems::Draw;
using problems::problem_entry;
using problems::ProblemParts;
using reports::compare_optimizers;
using reports::document_of;
using reports::markdown_report;
using reports::read_study;
namespace {

// y = (sinh x1, x1 x2), y* = (1, 1).
class Twist final : public DensePhysics {
 public:
  Twist() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override { y << std::sinh(x[0]), x[0] * x[1]; }
  void derivative(VectorRef x, BatchOut J) const override { J << std::cosh(x[0]), 0, x[1], x[0]; }
};

ProblemParts make_twist(const NoOptions&, const Draw& draw) {
  return {.physics = std::make_unique<Twist>(),
          .start = draw.start(Eigen::Vector2d(2, 2)),
          .target = Vector::Ones(2),
          .minimum = 0};
}

// θ ← θ − η sign(∇L) / √t
struct SignDescent {
  Real rate = 0.1;
  using State = Index;  // t
  State init(Index) const { return 0; }
  void update(VectorRef g, Vector& theta, State& t) const {
    theta -= rate / std::sqrt(static_cast<Real>(++t)) * g.cwiseSign();
  }
};
void fields(SignDescent& o, auto& field) { field("rate", o.rate, above(0), "step length η"); }

Catalog extended_catalog() {
  Catalog catalog = builtin_catalog();
  catalog.problems.add(problem_entry(
      {.name = "twist", .title = "Twist", .formula = "(sinh x₁, x₁ x₂)", .source = "here"},
      make_twist));
  catalog.optimizers.add(rule_entry<SignDescent>({.name = "sign-descent",
                                                  .title = "Sign descent",
                                                  .formula = "θ ← θ − η sign(∇L) / √t",
                                                  .source = "here"}));
  return catalog;
}

Suite everything_with_them() {
  const Budget budget{.iterations = 200, .work = 1000};
  return {.name = "extended",
          .title = "",
          .blocks = {
              {.problems = {"twist"}, .optimizers = {"*"}, .budget = budget},
              {.problems = {"square", "beale"}, .optimizers = {"@first-order"}, .budget = budget}}};
}

TEST(ThirdParty, ComponentsArePlannedRunAndReportedLikeAllOthers) {
  const Catalog catalog = extended_catalog();
  FinishedMatrix matrix(catalog, everything_with_them(), Rates::builtin());
  EXPECT_EQ(matrix.outcome.failures, std::vector<std::string>{});
  std::size_t theirs = 0;
  std::vector<PlannedCell> cells;
  for (const Record& record : matrix.records) {
    const Request& request = record.request;
    theirs += request.optimizer.name == "sign-descent";
    cells.push_back({record.cell, request.problem.spec, request.optimizer.spec, request.seed});
    matrix.store.write(problem_sheet(catalog, request.problem));
    matrix.store.write(optimizer_sheet(catalog, request.optimizer));
  }
  EXPECT_EQ(theirs, 3U);
  matrix.store.plan("extended", cells);
  const std::string page =
      markdown_report(document_of(compare_optimizers(read_study({matrix.folder.path()}))));
  for (const char* name : {"twist", "sign-descent"})
    EXPECT_NE(page.find(name), std::string::npos) << name;
}

TEST(ThirdParty, ComponentsArePreviewed) {
  const Catalog catalog = extended_catalog();
  const std::vector<Request> requests = expand(catalog, everything_with_them(), {});
  const TemporaryFolder folder;
  for (const PreviewedCell& cell : preview(catalog, requests, {folder.path()}).cells)
    EXPECT_EQ(cell.why_inapplicable.empty(), cell.is_missing()) << cell.request->optimizer.spec;
}

TEST(ThirdParty, SheetsOfEveryComponentConformToTheSchema) {
  const Catalog catalog = extended_catalog();
  const Json schema = parse_json(std::string(builtin_schemas().at("component")), "component");
  const auto expect_sound = [&](const Sheet& sheet) {
    const Json json = to_json(sheet);
    EXPECT_EQ(schema_violations(json, schema), std::vector<std::string>{}) << sheet.name;
    EXPECT_EQ(to_json(sheet_from_json(json)), json) << sheet.name;
  };
  for (const std::string& name : catalog.problems.ready().names())
    expect_sound(problem_sheet(catalog, complete_problem(catalog, name, OptionValues())));
  for (const std::string& name : catalog.optimizers.ready().names())
    expect_sound(optimizer_sheet(catalog, complete_optimizer(catalog, name, OptionValues())));
}

TEST(ThirdParty, APlanConformsToTheSchemaAndKeepsEarlierCells) {
  const Catalog catalog = extended_catalog();
  const TemporaryFolder folder;
  Store store(folder.path());
  store.plan("one", {{"0123456789abcdef", "twist", "gd", 0}});
  store.plan("two",
             {{"0123456789abcdef", "twist", "gd", 0}, {"fedcba9876543210", "twist", "sip", 0}});
  const Json plan = read_json(folder.path() / "plan.json");
  const Json schema = parse_json(std::string(builtin_schemas().at("plan")), "plan");
  EXPECT_EQ(schema_violations(plan, schema), std::vector<std::string>{});
  EXPECT_EQ(plan.at("cells").size(), 2U);
  EXPECT_EQ(plan.at("suites").size(), 2U);
}

}  // namespace
}  // namespace isoline::benchmarks
