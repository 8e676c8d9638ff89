#!/usr/bin/env bash
# Boost 1.74 autodiff: pow(x, 2) of an unknown at 0 is not a number, its value included; x * x is right.
#
# Guess before the run: a power with a constant exponent has the value and derivatives of the product
# that it stands for, at 0 as elsewhere; where a derivative does not exist, the value still does.
# Seen: at x = 0, with two derivatives, pow(x, 2.0), pow(x, 2) and pow(x, 3.0) are NaN in value, first
# and second derivative; x * x is 0, 0 and 2. At -1 all are right, and pow(x, 0.0) is 1 at 0. So a
# fit whose unknown starts at 0 has no value in its first call, though the formula in doubles has one.
# Write products.
. "$(dirname "$0")/packages.sh"
debian libboost1.74-dev=1.74.0+ds1-21
cat >"$work/run.cpp" <<'C'
#include <boost/math/differentiation/autodiff.hpp>
#include <cmath>
#include <cstdio>
using boost::math::differentiation::make_fvar;
using Number = decltype(make_fvar<double, 2>(0.0));
static void say(const char *name, double at, const Number &y) {
  std::printf("%s at %g:", name, at);
  for (int i = 0; i < 3; ++i) {
    const double v = y.derivative(i);
    if (std::isnan(v)) std::printf(" NaN");
    else std::printf(" %g", v);
  }
  std::puts("");
}
int main() {
  for (const double at : {-1.0, 0.0}) {
    const Number x = make_fvar<double, 2>(at);
    say("x * x", at, x * x);
    say("pow(x, 2.0)", at, pow(x, 2.0));
    say("pow(x, 2)", at, pow(x, 2));
    say("pow(x, 3.0)", at, pow(x, 3.0));
    say("pow(x, 0.0)", at, pow(x, 0.0));
  }
}
C
compile "$work/run.cpp" -std=c++17 -O0
expect 'x * x at -1: 1 -2 2
pow(x, 2.0) at -1: 1 -2 2
pow(x, 2) at -1: 1 -2 2
pow(x, 3.0) at -1: -1 3 -6
pow(x, 0.0) at -1: 1 0 0
x * x at 0: 0 0 2
pow(x, 2.0) at 0: NaN NaN NaN
pow(x, 2) at 0: NaN NaN NaN
pow(x, 3.0) at 0: NaN NaN NaN
pow(x, 0.0) at 0: 1 0 0' "$work/program"
