#!/usr/bin/env bash
# Trilinos ROL 13.2: with bounds and values only, 44,094 calls by default end at the start.
#
# Guess before the run: ROL takes differences of values for gradients, so that the default solver, a
# trust region, ends as it does with gradients, with some digits less.
# Seen: on Rosenbrock's function with x1 <= 0.5, from 24.2, it ends at 0.25 with gradients, after 16
# iterations. With values only it is at 24.14 after 2,000, and counts 2,001 of 44,094 calls: second
# derivatives are differences of differences, so they are noise. Without bounds it gets to 0.00, and
# goes on until its limit. A line search with "Quasi-Newton Method" ends at 0.25 after 111 calls.
# And with x in units of 1e-9 the solver says "Converged" at its start, as the gradient is below
# 1e-6.
. "$(dirname "$0")/packages.sh"
debian libtrilinos-rol-dev=13.2.0-4 libtrilinos-teuchos-dev=13.2.0-4 libtrilinos-kokkos-dev=13.2.0-4
cat >"$work/run.cpp" <<'C'
#include <ROL_Bounds.hpp>
#include <ROL_Objective.hpp>
#include <ROL_Problem.hpp>
#include <ROL_Solver.hpp>
#include <ROL_StdVector.hpp>
#include <ROL_Stream.hpp>
#include <cstdio>

using Vector = ROL::StdVector<double>;
static int calls;
static ROL::Ptr<Vector> vector(double a, double b) {
  return ROL::makePtr<Vector>(ROL::makePtr<std::vector<double>>(std::vector<double>{a, b}));
}
struct Rosenbrock : ROL::Objective<double> {
  double unit;
  bool differences;
  Rosenbrock(double unit, bool differences) : unit(unit), differences(differences) {}
  double value(const ROL::Vector<double>& point, double&) override {
    const auto& x = *dynamic_cast<const Vector&>(point).getVector();
    const double p = x[0] / unit, a = x[1] / unit - p * p;
    ++calls;
    return 100 * a * a + (1 - p) * (1 - p);
  }
  void gradient(ROL::Vector<double>& slope, const ROL::Vector<double>& point, double& tolerance) override {
    if (differences) return ROL::Objective<double>::gradient(slope, point, tolerance);
    const auto& x = *dynamic_cast<const Vector&>(point).getVector();
    auto& g = *dynamic_cast<Vector&>(slope).getVector();
    const double p = x[0] / unit, a = x[1] / unit - p * p;
    g[0] = (-400 * a * p - 2 * (1 - p)) / unit;
    g[1] = 200 * a / unit;
  }
};
static void run(const char* name, double unit, bool differences, bool bounded, bool search) {
  ROL::ParameterList choice;
  choice.sublist("Status Test").set("Iteration Limit", 2000);
  if (search) {
    choice.sublist("Step").set("Type", "Line Search");
    choice.sublist("Step").sublist("Line Search").sublist("Descent Method").set("Type", "Quasi-Newton Method");
  }
  const auto problem = ROL::makePtr<ROL::Problem<double>>(ROL::makePtr<Rosenbrock>(unit, differences),
                                                          vector(-1.2 * unit, unit));
  if (bounded)
    problem->addBoundConstraint(ROL::makePtr<ROL::Bounds<double>>(vector(-2 * unit, -2 * unit),
                                                                  vector(0.5 * unit, 2 * unit)));
  calls = 0;
  ROL::Solver<double> solver(problem, choice);
  ROL::nullstream quiet;
  solver.solve(quiet);
  const auto state = solver.getAlgorithmState();
  std::printf("%s%s: %s, f %.2f, %d iterations, calls %s, counted %s\n", name, bounded ? ", bounds" : "",
              ROL::EExitStatusToString(state->statusFlag).c_str(), state->value, state->iter,
              calls > 10000 ? "over 10000" : calls < 1000 ? "below 1000" : "thousands",
              state->nfval == calls ? "all" : "some");
}
int main() {
  run("gradients", 1, false, false, false);
  run("gradients", 1, false, true, false);
  run("values", 1, true, false, false);
  run("values", 1, true, true, false);
  run("values, quasi-Newton", 1, true, false, true);
  run("values, quasi-Newton", 1, true, true, true);
  run("gradients, large numbers", 1e9, false, false, false);
}
C
compile "$work/run.cpp" -O0 -std=c++17 -I"$root/usr/include/trilinos" -ltrilinos_teuchosparameterlist \
  -ltrilinos_teuchosnumerics -ltrilinos_teuchoscomm -ltrilinos_teuchoscore -ltrilinos_rol
expect 'gradients: Converged, f 0.00, 45 iterations, calls below 1000, counted all
gradients, bounds: Converged, f 0.25, 16 iterations, calls below 1000, counted all
values: Iteration Limit Exceeded, f 0.00, 2000 iterations, calls thousands, counted some
values, bounds: Iteration Limit Exceeded, f 24.14, 2000 iterations, calls over 10000, counted some
values, quasi-Newton: Step Tolerance Met, f 0.00, 22 iterations, calls below 1000, counted some
values, quasi-Newton, bounds: Converged, f 0.25, 25 iterations, calls below 1000, counted some
gradients, large numbers: Converged, f 24.20, 0 iterations, calls below 1000, counted all' "$work/program"
