#!/usr/bin/env bash
# VNL of ITK 5.2.1: conjugate gradients say true at their limit, and Powell's method passes it 30 times.
#
# Guess before the run: set_max_function_evals(20) ends each minimizer after 20 calls or a few more,
# minimize() returns false then, with a failure code, and the counter is that of the calls.
# Seen: on Rosenbrock's function vnl_conjugate_gradient takes 20 as iterations: 70 calls, 67 counted, a
# value of 0.72, where the least is 0, and true, as for a fit. vnl_powell makes 604 calls, since one
# iteration is not interrupted, and is at the minimum. vnl_lbfgs and vnl_lbfgsb make 21, with false and
# code 5; vnl_amoeba counts 3 too few. Read get_end_error() and your own counter.
. "$(dirname "$0")/packages.sh"
debian libinsighttoolkit5-dev=5.2.1-5+deb12u1
cat >"$work/run.cpp" <<'C'
#include <cstdio>
#include <vnl/algo/vnl_amoeba.h>
#include <vnl/algo/vnl_conjugate_gradient.h>
#include <vnl/algo/vnl_lbfgs.h>
#include <vnl/algo/vnl_lbfgsb.h>
#include <vnl/algo/vnl_powell.h>
#include <vnl/vnl_cost_function.h>

using Vector = vnl_vector<double>;
struct Rosenbrock : vnl_cost_function {
  int calls = 0;
  Rosenbrock() : vnl_cost_function(2) {}
  double f(const Vector& x) override {
    const double a = x[1] - x[0] * x[0], b = 1 - x[0];
    ++calls;
    return 100 * a * a + b * b;
  }
  void gradf(const Vector& x, Vector& g) override {
    const double a = x[1] - x[0] * x[0];
    g[0] = -400 * a * x[0] - 2 * (1 - x[0]);
    g[1] = 200 * a;
  }
};
static Vector start() {
  Vector x(2);
  x[0] = -1.2;
  x[1] = 1;
  return x;
}
template <class Method>
void run(const char* name, Method&& method, Rosenbrock& cost, int limit) {
  cost.calls = 0;
  method.set_max_function_evals(limit);
  Vector x = start();
  const bool success = method.minimize(x);
  const int calls = cost.calls;
  std::printf("%s, limit %d: %s, code %d, value %.2f, calls %d, counted %d\n", name, limit, success ? "true" : "false",
              static_cast<int>(method.get_failure_code()), cost.f(x), calls, method.get_num_evaluations());
}
int main() {
  Rosenbrock cost;
  run("conjugate gradients", vnl_conjugate_gradient(cost), cost, 2000);
  run("conjugate gradients", vnl_conjugate_gradient(cost), cost, 20);
  run("Powell", vnl_powell(&cost), cost, 20);
  run("L-BFGS", vnl_lbfgs(cost), cost, 20);
  run("L-BFGS-B", vnl_lbfgsb(cost), cost, 20);
  vnl_amoeba simplex(cost);
  Vector x = start();
  cost.calls = 0;
  simplex.minimize(x);
  std::printf("amoeba: calls %d, counted %d\n", cost.calls, simplex.get_num_evaluations());
}
C
compile "$work/run.cpp" -std=c++17 -I"$root/usr/include/ITK-5.2" -L"$root/usr/lib" -litkvnl_algo-5.2 -litkvnl-5.2 \
  -litkv3p_netlib-5.2 -litkvcl-5.2
expect 'conjugate gradients, limit 2000: true, code -1, value 0.00, calls 192, counted 188
conjugate gradients, limit 20: true, code -1, value 0.72, calls 70, counted 67
Powell, limit 20: true, code -1, value 0.00, calls 604, counted 604
L-BFGS, limit 20: false, code 5, value 1.30, calls 21, counted 21
L-BFGS-B, limit 20: false, code 5, value 1.30, calls 21, counted 21
amoeba: calls 321, counted 318' "$work/program"
