// Ipopt with a limited-memory Hessian, within bounds.
// flags: -lipopt
#include <coin/IpStdCInterface.h>

#include "peer.h"

Bool value(Index, Number* x, Bool, Number* f, void* peer) {
  *f = static_cast<Peer*>(peer)->value(x);
  return TRUE;
}
Bool slope(Index, Number* x, Bool, Number* g, void* peer) {
  static_cast<Peer*>(peer)->value(x, g);
  return TRUE;
}
Bool no_constraint(Index, Number*, Bool, Index, Number*, void*) { return TRUE; }
Bool no_slopes(Index, Number*, Bool, Index, Index, Index*, Index*, Number*, void*) { return TRUE; }
Bool no_hessian(Index, Number*, Bool, Number, Index, Number*, Bool, Index, Index*, Index*, Number*,
                void*) {
  return FALSE;
}

int main() {
  Peer p({.name = "ipopt", .needs = "\"pullback\"", .keeps_bounds = true});
  IpoptProblem problem =
      CreateIpoptProblem(static_cast<Index>(p.n), p.lower.data(), p.upper.data(), 0, nullptr,
                         nullptr, 0, 0, 0, value, no_constraint, slope, no_slopes, no_hessian);
  const auto name = [](const char* text) { return const_cast<char*>(text); };
  AddIpoptStrOption(problem, name("hessian_approximation"), name("limited-memory"));
  AddIpoptStrOption(problem, name("sb"), name("yes"));
  AddIpoptIntOption(problem, name("print_level"), 0);
  AddIpoptIntOption(problem, name("max_iter"), 1 << 30);
  AddIpoptNumOption(problem, name("tol"), 1e-10);
  AddIpoptNumOption(problem, name("bound_relax_factor"),
                    0);  // by default it leaves the bounds by 1e-8
  double best = 0;
  const int code = IpoptSolve(problem, p.x0.data(), nullptr, &best, nullptr, nullptr, nullptr, &p);
  p.finish(p.x0.data(), "status " + std::to_string(code) + " of ApplicationReturnStatus");
}
