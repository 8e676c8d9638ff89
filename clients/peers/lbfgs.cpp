// L-BFGS of liblbfgs, with its default line search.
// flags: -llbfgs
#include <lbfgs.h>

#include "peer.h"

int main() {
  Peer p({.name = "liblbfgs", .needs = "\"pullback\""});
  lbfgs_parameter_t parameters;
  lbfgs_parameter_init(&parameters);
  parameters.epsilon = 1e-10;
  double value = 0;
  const auto evaluate = [](void* peer, const double* x, double* g, int, double) {
    return static_cast<Peer*>(peer)->value(x, g);
  };
  const int code =
      lbfgs(static_cast<int>(p.n), p.x0.data(), &value, evaluate, nullptr, &p, &parameters);
  p.finish(p.x0.data(), "code " + std::to_string(code));
}
