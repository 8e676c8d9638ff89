// flags: -ldlib -lblas -lalglib
// Methods of dlib and ALGLIB by their defaults. Values come by lines on standard input; each is one
// call of the callback.
#include "methods.h"

#include <dlib/global_optimization.h>
#include <dlib/optimization.h>
#include <libalglib/optimization.h>

using Point = dlib::matrix<double, 0, 1>;
using alglib::real_1d_array;

void residual(const real_1d_array& x, real_1d_array& r, void*) {
  const Vector found = ask("residual", &x[0]);
  std::copy(found.begin(), found.end(), &r[0]);
}
void slope(const real_1d_array& x, double& value, real_1d_array& g, void*) {
  const Vector found = ask("gradient", &x[0]);
  std::copy(found.begin(), found.end(), &g[0]);
  value = ask("value", &x[0])[0];
}

template <class Report>
void finish(const Report& report, const std::string& own, const real_1d_array& x) {
  finish(report.terminationtype > 0, own, "type_" + std::to_string(report.terminationtype), &x[0]);
}

void run_alglib(const std::string& method) {
  real_1d_array x, lower, upper;
  x.setcontent(given.n, given.x.data());
  lower.setcontent(given.n, given.lower.data());
  upper.setcontent(given.n, given.upper.data());
  if (method == "minlm") {
    alglib::minlmstate state;
    alglib::minlmreport report;
    minlmcreatev(given.m, x, 1e-4, state);
    if (given.has_bounds) minlmsetbc(state, lower, upper);
    minlmoptimize(state, residual);
    minlmresults(state, x, report);
    finish(report, std::to_string(report.nfunc), x);
  } else if (method == "minlbfgs") {
    alglib::minlbfgsstate state;
    alglib::minlbfgsreport report;
    minlbfgscreate(given.n, x, state);
    minlbfgsoptimize(state, slope);
    minlbfgsresults(state, x, report);
    finish(report, std::to_string(report.nfev), x);
  } else {
    alglib::minbleicstate state;
    alglib::minbleicreport report;
    minbleiccreate(x, state);
    if (given.has_bounds) minbleicsetbc(state, lower, upper);
    minbleicoptimize(state, slope);
    minbleicresults(state, x, report);
    finish(report, std::to_string(report.nfev), x);
  }
}

void run_dlib(const std::string& method) {
  const long n = static_cast<long>(given.n);
  Point x = dlib::mat(given.x);
  const auto value = [](const Point& at) { return ask("value", &at(0))[0]; };
  const auto gradient = [](const Point& at) {
    const Vector found = ask("gradient", &at(0));
    return Point(dlib::mat(found));
  };
  try {
    if (method == "lbfgs") {
      dlib::find_min(dlib::lbfgs_search_strategy(10), dlib::objective_delta_stop_strategy(1e-9),
                     value, gradient, x, -1e300);
    } else {
      const auto [low, high] = finite_bounds();
      const Point lower = dlib::mat(low), upper = dlib::mat(high);
      const auto most = [](std::size_t otherwise) { return given.limit ? given.limit : otherwise; };
      if (method == "global") {
        const dlib::max_function_calls calls(most(200));
        x = dlib::find_min_global(value, lower, upper, calls, dlib::FOREVER, 0).x;
      } else {
        dlib::find_min_bobyqa(value, x, 2 * n + 1, lower, upper, 0.1, 1e-8, most(100000));
      }
    }
    finish(method != "global", "none", "returned", &x(0));
  } catch (const dlib::bobyqa_failure&) {
    finish(false, "none", "bobyqa_failure", &x(0));
  }
}

int main(int, char** words) {
  const std::string package = words[1], method = words[2];
  run_each([&] { package == "dlib" ? run_dlib(method) : run_alglib(method); });
}
