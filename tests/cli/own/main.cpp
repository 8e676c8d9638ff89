// A program built elsewhere: Isoline's verbs over a catalog with problems of its own: a sound one,
// one that throws and one that aborts when it is evaluated.
#include <cmath>
#include <cstdlib>

#include "benchmarks/cli/program.h"
#include "isoline_build_info.h"
#include "problems/dense_physics.h"
#include "problems/problem.h"

namespace isoline {
namespace {

using benchmarks::Catalog;
using problems::DensePhysics;
using problems::Draw;
using problems::problem_entry;
using problems::ProblemParts;

void do_nothing() {}
void throw_on_purpose() { throw std::runtime_error("it's on purpose"); }

// y = (sinh x1, x1 x2), y* = (1, 1), after something else.
template <void (*before)()>
class Twist final : public DensePhysics {
 public:
  Twist() : DensePhysics(2, 2) {}
  void value(VectorRef x, VectorOut y) const override {
    before();
    y << std::sinh(x[0]), x[0] * x[1];
  }
  void derivative(VectorRef x, BatchOut J) const override { J << std::cosh(x[0]), 0, x[1], x[0]; }
};

template <void (*before)()>
ProblemParts parts(const NoOptions&, const Draw& draw) {
  return {.physics = std::make_unique<Twist<before>>(),
          .start = draw.start(Eigen::Vector2d(2, 2)),
          .target = Vector::Ones(2),
          .minimum = 0};
}

Catalog with_mine() {
  Catalog catalog = benchmarks::builtin_catalog();
  const auto add = [&](const char* name, const char* title, auto make) {
    catalog.problems.add(problem_entry(
        {.name = name, .title = title, .formula = "(sinh x₁, x₁ x₂)", .source = "here"}, make));
  };
  add("twist", "Twist", parts<do_nothing>);
  add("thrower", "Thrower", parts<throw_on_purpose>);
  add("aborter", "Aborter", parts<std::abort>);
  return catalog;
}

}  // namespace
}  // namespace isoline

int main(int count, char** arguments) {
  return isoline::main(count, arguments, isoline::with_mine, {kCommit, kDirty, kSources});
}
