#!/usr/bin/env bash
# dlib 19.24 find_min_global: how long a function takes decides where it is evaluated, so runs do not repeat each other.
#
# Guess before the run: its seed is fixed and it uses one thread, so a second run makes the calls of the first.
# Seen: so it is for a function that answers at once, and for one of 4 ms. With 200 microseconds, runs differ from the 23rd
# call on. It compares the mean time of a call with that of its own search, and searches less, in the end at random, where
# calls are faster. No seed brings a result back: keep the evaluated points.
. "$(dirname "$0")/packages.sh"
debian libdlib-dev=19.24+dfsg-1 libdlib19.1=19.24+dfsg-1 libblas-dev=3.11.0-2 liblapack-dev=3.11.0-2
cat >"$work/run.cpp" <<'C'
#include <cstdio>
#include <dlib/global_optimization.h>
#include <unistd.h>
#include <vector>

static std::vector<double> points;
static double valley(const dlib::matrix<double, 0, 1> &x) {
  usleep(200);
  points.insert(points.end(), x.begin(), x.end());
  const double a = x(1) - x(0) * x(0), b = 1 - x(0);
  return 100 * a * a + b * b;
}
static std::vector<double> run() {
  points.clear();
  dlib::find_min_global(valley, {-2, -2}, {0.5, 2}, dlib::max_function_calls(150));
  return points;
}
int main() {
  const std::vector<double> first = run();
  int others = 0;
  for (int i = 0; i < 5; ++i) others += run() != first;
  std::printf("%s\n", others > 0 ? "runs differ" : "all runs agree");
}
C
compile "$work/run.cpp" -ldlib -lblas -llapack
expect 'runs differ' "$work/program"
