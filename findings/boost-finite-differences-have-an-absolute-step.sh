#!/usr/bin/env bash
# Boost.Math 1.74 finite_difference_derivative: one absolute step for all x, so log is asked below 0 from x = 1e-3 on.
#
# Guess before the run: the step follows |x|, so that d log x/dx times x is 1 to nine digits at 1e-6 and at 1e9.
# Seen: the default, of order 6, steps by about 0.01 whatever x is: NaN at 1e-3 and below, and 4e-4 off at 1e9. Its
# error estimate does say so at large x (0.02 in the same units), and is NaN at small ones. Scale x first.
. "$(dirname "$0")/packages.sh"
debian libboost1.74-dev=1.74.0+ds1-21
cat >"$work/step.cpp" <<'C'
#include <boost/math/differentiation/finite_difference.hpp>
#include <cmath>
#include <algorithm>
#include <cstdio>
int main() {
  double least = 1e300;
  auto f = [&](double v) { least = std::min(least, v); return std::log(v); };
  for (double x : {1e-6, 1e-3, 1.0, 1e6, 1e9}) {
    double error;
    const double d = boost::math::differentiation::finite_difference_derivative(f, x, &error);
    if (std::isnan(d)) std::printf("x = %g: not a number\n", x);
    else std::printf("x = %g: %.4f, estimated error %.0e\n", x, d * x, error * x);
  }
  std::printf("least argument %s\n", least < -0.005 ? "below -0.005" : "above");
}
C
compile "$work/step.cpp" -std=c++17
expect "$(cat <<'S'
x = 1e-06: not a number
x = 0.001: not a number
x = 1: 1.0000, estimated error 5e-15
x = 1e+06: 1.0000, estimated error 1e-05
x = 1e+09: 1.0004, estimated error 2e-02
least argument below -0.005
S
)" "$work/program"
