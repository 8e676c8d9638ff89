// The time integrator that problems of differential equations share: the classical method of Runge
// and Kutta, of fourth order, for any scalar, so that jets differentiate the discrete solution.
#pragma once

#include <array>

#include "core/real.h"

namespace isoline::problems {

// The state after so many steps of dt, where rate(t, s) is ṡ.
template <class State, class Rate>
State after_steps(State s, Real t, Real dt, int steps, const Rate& rate) {
  const auto moved = [](const State& from, const State& along, Real by) {
    State to = from;
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += by * along[i];
    return to;
  };
  for (int step = 0; step < steps; ++step, t += dt) {
    const State a = rate(t, s), b = rate(t + dt / 2, moved(s, a, dt / 2)),
                c = rate(t + dt / 2, moved(s, b, dt / 2)), d = rate(t + dt, moved(s, c, dt));
    for (std::size_t i = 0; i < s.size(); ++i)
      s[i] += dt / 6 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
  }
  return s;
}

}  // namespace isoline::problems
