#!/usr/bin/env bash
# ADOL-C 2.7.2: on the other branch of an `if`, value and gradient stay those of the last call, as if the point had not moved.
#
# Guess before the run: a tape evaluated where the comparison goes the other way gives the values of the taped branch, or
# an error that cannot be missed.
# Seen: |x - 3| taped at 5 with `if (x > 3)` is still 2 at 0, and its gradient 1, where 3 and -1 are right: function() and
# gradient() return -1, write a warning to standard error, and leave their outputs alone. Check each code and tape again;
# condassign has no branch. And the second derivative of pow(x, y) with an active y = 2 is not a number at 0, with a good
# code; with y = 2.0 as a double it is 2.
. "$(dirname "$0")/packages.sh"
debian libadolc-dev=2.7.2-6
cat >"$work/run.cpp" <<'C'
#include <adolc/adolc.h>
#include <cmath>
#include <cstdio>
template <class F>
void tape(short tag, double at, F f) {
  double y;
  trace_on(tag);
  adouble x;
  x <<= at;
  adouble r = f(x);
  r >>= y;
  trace_off();
}
double y, g;  // of the last call
void show(const char *name, short tag, double at) {
  double **H = myalloc2(1, 1);
  const int code = function(tag, 1, 1, &at, &y);
  gradient(tag, 1, &at, &g);
  hessian(tag, 1, &at, H);
  std::printf("%s at %g: value %g, gradient %g, second %s, code %s\n", name, at, y, g,
              std::isnan(H[0][0]) ? "not a number" : H[0][0] == 2 ? "2" : "0", code < 0 ? "negative" : "good");
}
int main() {
  tape(1, 5, [](adouble x) { adouble r; if (x > 3) r = x - 3; else r = 3 - x; return r; });
  show("|x - 3|", 1, 5);
  show("|x - 3|", 1, 0);
  tape(2, 0, [](adouble x) { return adouble(pow(x, 2.0)); });
  show("pow(x, 2.0)", 2, 0);
  tape(3, 0, [](adouble x) { adouble two = 2; return adouble(pow(x, two)); });
  show("pow(x, two)", 3, 0);
}
C
compile "$work/run.cpp" -ladolc
run() { "$work/program" 2>"$work/warnings"; grep -c -i warning "$work/warnings" >/dev/null && echo "warnings on standard error"; }
expect "$(cat <<'S'
|x - 3| at 5: value 2, gradient 1, second 0, code good
|x - 3| at 0: value 2, gradient 1, second 0, code negative
pow(x, 2.0) at 0: value 0, gradient 0, second 2, code good
pow(x, two) at 0: value 0, gradient 0, second not a number, code good
warnings on standard error
S
)" run
