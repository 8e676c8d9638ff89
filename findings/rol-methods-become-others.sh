#!/usr/bin/env bash
# Trilinos ROL 13.2: with bounds, Newton's method is steepest descent; 14 of 264 gradients count.
#
# Guess before the run: a method that ROL cannot combine with bounds is refused by name, and the
# counters of values and gradients are those of the calls.
# Seen: Rosenbrock's function, x1 <= 0.5, with a gradient. The line searches "Newton's Method",
# "Nonlinear CG" and "Steepest Descent" make the same 857 calls in 385 iterations; "Newton-Krylov"
# needs 13. Without bounds "Newton's Method" is refused. All subproblem solvers of the trust region
# run alike with bounds, as "Lin-More"; without bounds "Lin-More" and "Kelley Sachs" are "Cauchy
# Point", which has not converged after 2,000 iterations. Second derivatives are differences of
# gradients, which ngrad leaves out: 14 for 264 calls, some of them outside the bounds. "Primal Dual
# Active Set" ends at 506.5, from 24.2.
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
static int values, gradients;
static ROL::Ptr<Vector> vector(double a, double b) {
  return ROL::makePtr<Vector>(ROL::makePtr<std::vector<double>>(std::vector<double>{a, b}));
}
struct Rosenbrock : ROL::Objective<double> {
  double value(const ROL::Vector<double>& point, double&) override {
    const auto& x = *dynamic_cast<const Vector&>(point).getVector();
    const double a = x[1] - x[0] * x[0], b = 1 - x[0];
    ++values;
    return 100 * a * a + b * b;
  }
  void gradient(ROL::Vector<double>& slope, const ROL::Vector<double>& point, double&) override {
    const auto& x = *dynamic_cast<const Vector&>(point).getVector();
    auto& g = *dynamic_cast<Vector&>(slope).getVector();
    const double a = x[1] - x[0] * x[0];
    ++gradients;
    g[0] = -400 * a * x[0] - 2 * (1 - x[0]);
    g[1] = 200 * a;
  }
};
static void run(bool bounded, const char* step, const char* name) {
  ROL::ParameterList choice;
  choice.sublist("Step").set("Type", step);
  choice.sublist("Step").sublist("Line Search").sublist("Descent Method").set("Type", name);
  choice.sublist("Step").sublist("Trust Region").set("Subproblem Solver", name);
  choice.sublist("Status Test").set("Iteration Limit", 2000);
  const auto problem = ROL::makePtr<ROL::Problem<double>>(ROL::makePtr<Rosenbrock>(), vector(-1.2, 1));
  if (bounded) problem->addBoundConstraint(ROL::makePtr<ROL::Bounds<double>>(vector(-2, -2), vector(0.5, 2)));
  values = gradients = 0;
  std::printf("%s%s, %s: ", bounded ? "bounds, " : "", step, name);
  try {
    ROL::Solver<double> solver(problem, choice);
    ROL::nullstream quiet;
    solver.solve(quiet);
    const auto state = solver.getAlgorithmState();
    std::printf("%s, f %.4g, %d iterations, values %d of %d, gradients %d of %d\n",
                ROL::EExitStatusToString(state->statusFlag).c_str(), state->value, state->iter, state->nfval, values,
                state->ngrad, gradients);
  } catch (const std::exception&) {
    std::puts("refused");
  }
}
int main() {
  for (const char* name : {"Steepest Descent", "Nonlinear CG", "Newton's Method", "Newton-Krylov"})
    run(true, "Line Search", name);
  run(false, "Line Search", "Newton's Method");
  for (const char* name : {"Cauchy Point", "Dogleg", "SPG", "Lin-More"}) run(true, "Trust Region", name);
  for (const char* name : {"Cauchy Point", "Lin-More", "Kelley Sachs", "SPG"}) run(false, "Trust Region", name);
  run(true, "Primal Dual Active Set", "");
}
C
compile "$work/run.cpp" -O0 -std=c++17 -I"$root/usr/include/trilinos" -ltrilinos_teuchosparameterlist \
  -ltrilinos_teuchosnumerics -ltrilinos_teuchoscomm -ltrilinos_teuchoscore -ltrilinos_rol
expect "bounds, Line Search, Steepest Descent: Converged, f 0.25, 385 iterations, values 857 of 857, gradients 386 of 386
bounds, Line Search, Nonlinear CG: Converged, f 0.25, 385 iterations, values 857 of 857, gradients 386 of 386
bounds, Line Search, Newton's Method: Converged, f 0.25, 385 iterations, values 857 of 857, gradients 386 of 386
bounds, Line Search, Newton-Krylov: Converged, f 0.25, 13 iterations, values 22 of 22, gradients 14 of 70
Line Search, Newton's Method: refused
bounds, Trust Region, Cauchy Point: Converged, f 0.25, 16 iterations, values 17 of 17, gradients 14 of 264
bounds, Trust Region, Dogleg: Converged, f 0.25, 16 iterations, values 17 of 17, gradients 14 of 264
bounds, Trust Region, SPG: Converged, f 0.25, 16 iterations, values 17 of 17, gradients 14 of 264
bounds, Trust Region, Lin-More: Converged, f 0.25, 16 iterations, values 17 of 17, gradients 14 of 264
Trust Region, Cauchy Point: Iteration Limit Exceeded, f 5.51e-05, 2000 iterations, values 2002 of 2002, gradients 1959 of 5961
Trust Region, Lin-More: Iteration Limit Exceeded, f 5.51e-05, 2000 iterations, values 2002 of 2002, gradients 1959 of 5961
Trust Region, Kelley Sachs: Iteration Limit Exceeded, f 5.51e-05, 2000 iterations, values 2002 of 2002, gradients 1959 of 5961
Trust Region, SPG: Converged, f 5.658e-17, 24 iterations, values 26 of 26, gradients 23 of 827
bounds, Primal Dual Active Set, : Step Tolerance Met, f 506.5, 4 iterations, values 5 of 5, gradients 5 of 89" "$work/program"
