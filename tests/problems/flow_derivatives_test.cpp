// The derivatives of the flow: against each other and against differences.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "flow_cases.h"

namespace isoline::problems {
namespace {

struct Trial {
  FlowOptions options;
  Index steps = 8;
  const char* name;
};
const Trial kTrials[] = {
    {.options = {.N = 16}, .name = "staggered"},
    {.options = {.N = 16, .arrangement = Arrangement::collocated}, .name = "collocated"},
    {.options = {.N = 16, .viscosity = 3}, .name = "viscous"},
    {.options = {.N = 12, .rescales = false}, .steps = 5, .name = "not rescaled"}};

// From x to the last state, with its products.
struct Map {
  Simulation flow;
  FlowRun run;
  Vector marker;
  Index cells;

  explicit Map(const Trial& trial)
      : flow(trial.options, trial.steps), cells(trial.options.cells()) {
    marker = Golden::state(trial.options).tail(cells);
  }
  Vector value(VectorRef x) {
    flow.begin(x, marker, run);
    flow.forward(run);
    return run.states.rightCols<1>();
  }
  Vector push(VectorRef v) {
    Vector tangent = Vector::Zero(3 * cells);
    flow.begin_pushforward(v, tangent.head(2 * cells));
    flow.pushforward(run, tangent);
    return tangent;
  }
  Vector pull(Vector cotangent) {
    flow.pullback(run, cotangent);
    Vector out(2 * cells);
    flow.begin_pullback(cotangent.head(2 * cells), out);
    return out;
  }
};

Vector smooth_velocity(const FlowOptions& o) {
  return Golden::state({.N = o.N, .arrangement = Arrangement::collocated}).head(2 * o.cells()) +
         0.3 * noise_of(o, "start").head(2 * o.cells());
}

TEST(Flow, HasAPullbackThatIsTheAdjointOfItsPushforward) {
  for (const Trial& trial : kTrials) {
    Map map(trial);
    map.value(smooth_velocity(trial.options));
    const Vector v = noise_of(trial.options, "tangent").head(2 * map.cells);
    const Vector u = noise_of(trial.options, "cotangent");
    const Vector Jv = map.push(v), JTu = map.pull(u);
    EXPECT_NEAR(u.dot(Jv), v.dot(JTu), 1e-12 * u.norm() * Jv.norm()) << trial.name;
  }
}

// The median over directions, for some cross a switch of the limiter, where the flow jumps.
TEST(Flow, HasAPushforwardThatLeavesARemainderOfSecondOrder) {
  for (const Trial& trial : kTrials) {
    Map map(trial);
    const Vector x = smooth_velocity(trial.options), y = map.value(x);
    std::vector<Real> slopes;
    for (int i = 0; i < 15; ++i) {
      const Vector v =
          noise_of(trial.options, "direction " + std::to_string(i)).head(2 * map.cells);
      map.value(x);
      const Vector Jv = map.push(v);
      const auto remainder = [&](Real h) { return (map.value(x + h * v) - y - h * Jv).norm(); };
      slopes.push_back(std::log10(remainder(1e-5) / remainder(1e-6)));
    }
    std::nth_element(slopes.begin(), slopes.begin() + 7, slopes.end());
    EXPECT_NEAR(slopes[7], 2, 0.05) << trial.name;
  }
}

}  // namespace
}  // namespace isoline::problems
