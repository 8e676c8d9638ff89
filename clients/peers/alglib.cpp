// ALGLIB's minlm, Levenberg-Marquardt with the Jacobian, within bounds.
// flags: -lalglib
#include <libalglib/optimization.h>

#include "peer.h"
using alglib::real_1d_array;

void residual(const real_1d_array& x, real_1d_array& r, void* peer) {
  const Peer::Vector found = static_cast<Peer*>(peer)->residual(&x[0]);
  std::copy(found.begin(), found.end(), &r[0]);
}
void jacobian(const real_1d_array& x, real_1d_array& r, alglib::real_2d_array& J, void* peer) {
  residual(x, r, peer);
  const Peer::Vector found = static_cast<Peer*>(peer)->jacobian(&x[0]);
  for (std::size_t i = 0; i < found.size(); ++i) J[i % r.length()][i / r.length()] = found[i];
}

int main() {
  Peer p({.name = "alglib-minlm",
          .needs = "\"jacobian\"",
          .least_squares = true,
          .keeps_bounds = true,
          .failed = 1e50});
  real_1d_array x, lower, upper;
  x.setcontent(p.n, p.x0.data());
  lower.setcontent(p.n, p.lower.data());
  upper.setcontent(p.n, p.upper.data());
  alglib::minlmstate state;
  alglib::minlmreport report;
  minlmcreatevj(p.m, x, state);
  minlmsetbc(state, lower, upper);
  minlmsetcond(state, 1e-12, 0);
  minlmoptimize(state, residual, jacobian, nullptr, &p);
  minlmresults(state, x, report);
  p.finish(&x[0], "type " + std::to_string(report.terminationtype));
}
