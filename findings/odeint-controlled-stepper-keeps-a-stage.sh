#!/usr/bin/env bash
# Boost.odeint 1.74: a controlled dopri5 that is passed by reference starts with the last stage of the model before.
#
# Guess before the run: integrate_adaptive restarts a stepper that it gets by boost::ref, so y(p) has the bits of a new one.
# Seen: dopri5 reuses its last derivative (first same as last) as that of the new start. y changes in the sixth digit, and a
# difference over 1e-8 p is wrong by 262 times; Cash-Karp, which has no such stage, and dense output are exact. Passing the
# stepper by value, as most examples do, mends it. Van der Pol's oscillator, y_1(7.3) at mu = 2; dy_1/dmu = -1.455.
. "$(dirname "$0")/packages.sh"
debian libboost1.74-dev=1.74.0+ds1-21
cat >"$work/stage.cpp" <<'C'
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cstdio>
using namespace boost::numeric::odeint;
using State = std::array<double, 2>;
double mu;
void rhs(const State& y, State& d, double) { d = {y[1], mu * (1 - y[0] * y[0]) * y[1] - y[0]}; }
template <class Stepper>
double solve(Stepper&& stepper, double at) {
  mu = at;
  State y{2, 0};
  integrate_adaptive(stepper, rhs, y, 0.0, 7.3, 1e-3);
  return y[0];
}
template <class Make>
void compare(const char* name, Make make) {
  const double h = 2e-8, a = solve(make(), 2), b = solve(make(), 2 + h);
  auto kept = make();
  const double first = solve(boost::ref(kept), 2), next = solve(boost::ref(kept), 2 + h);
  std::printf("%s: new %.2f, by reference %.1f, same bits %d\n", name, (b - a) / h, (next - first) / h,
              first == solve(boost::ref(kept), 2));
}
int main() {
  compare("dopri5", [] { return make_controlled(1e-6, 1e-6, runge_kutta_dopri5<State>()); });
  compare("Cash-Karp", [] { return make_controlled(1e-6, 1e-6, runge_kutta_cash_karp54<State>()); });
  compare("dense output of dopri5", [] { return make_dense_output(1e-6, 1e-6, runge_kutta_dopri5<State>()); });
}
C
compile "$work/stage.cpp" -std=c++17
expect 'dopri5: new -1.45, by reference -381.1, same bits 0
Cash-Karp: new -1.45, by reference -1.5, same bits 1
dense output of dopri5: new -1.45, by reference -1.5, same bits 1' "$work/program"
