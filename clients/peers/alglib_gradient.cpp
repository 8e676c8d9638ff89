// Methods of ALGLIB by gradients: minlbfgs, or minbleic within bounds.
// flags: -lalglib
#include <libalglib/optimization.h>

#include "peer.h"
using alglib::real_1d_array;

void slope(const real_1d_array& x, double& value, real_1d_array& g, void* peer) {
  value = static_cast<Peer*>(peer)->value(&x[0], &g[0]);
}

int main(int, char** words) {
  const std::string method = words[1];
  const bool has_bounds = method == "minbleic";
  Peer p({.name = "alglib-" + method, .needs = "\"pullback\"", .keeps_bounds = has_bounds});
  real_1d_array x, lower, upper;
  x.setcontent(p.n, p.x0.data());
  lower.setcontent(p.n, p.lower.data());
  upper.setcontent(p.n, p.upper.data());
  const auto end = [&](int type) { p.finish(&x[0], "type " + std::to_string(type)); };
  if (has_bounds) {
    alglib::minbleicstate state;
    alglib::minbleicreport report;
    minbleiccreate(x, state);
    minbleicsetbc(state, lower, upper);
    minbleicsetcond(state, 1e-10, 0, 0, 0);
    minbleicoptimize(state, slope, nullptr, &p);
    minbleicresults(state, x, report);
    return end(report.terminationtype), 0;
  }
  alglib::minlbfgsstate state;
  alglib::minlbfgsreport report;
  minlbfgscreate(std::min<int>(p.n, 10), x, state);
  minlbfgssetcond(state, 1e-10, 0, 0, 0);
  minlbfgsoptimize(state, slope, nullptr, &p);
  minlbfgsresults(state, x, report);
  end(report.terminationtype);
}
