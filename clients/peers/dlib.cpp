// A method of dlib: bobyqa, lbfgs, or global (find_min_global, within bounds that it needs).
// flags: -ldlib -lblas
#include <dlib/global_optimization.h>
#include <dlib/optimization.h>

#include "peer.h"
using Point = dlib::matrix<double, 0, 1>;

int main(int, char** words) {
  const std::string method = words[1];
  const bool is_lbfgs = method == "lbfgs";
  Peer p({.name = "dlib-" + method,
          .needs = is_lbfgs ? "\"pullback\"" : "",
          .keeps_bounds = !is_lbfgs});
  const auto value = [&](const Point& x) { return p.value(&x(0)); };
  const auto slope = [&](const Point& x) {
    Point g(x.size());
    p.value(&x(0), &g(0));
    return g;
  };
  const long n = static_cast<long>(p.n);
  Point x(n), lower(n), upper(n);
  constexpr double kFar = 1e3;  // bobyqa and global take finite bounds alone
  for (long i = 0; i < n; ++i) {
    x(i) = p.x0[i];
    lower(i) = std::max(p.lower[i], x(i) - kFar);
    upper(i) = std::min(p.upper[i], x(i) + kFar);
  }
  if (is_lbfgs) {
    const dlib::gradient_norm_stop_strategy stop(1e-10);
    dlib::find_min(dlib::lbfgs_search_strategy(10), stop, value, slope, x, 0);
  } else if (method == "bobyqa") {
    const double radius = std::min(1.0, 0.45 * dlib::min(upper - lower));
    dlib::find_min_bobyqa(value, x, 2 * n + 1, lower, upper, radius, 1e-9, 1 << 30);
  } else {
    const dlib::max_function_calls most(100000);
    x = dlib::find_min_global(value, lower, upper, most, dlib::FOREVER, 0).x;
  }
  p.finish(&x(0), "returned");
}
