// Predator and prey, Lotka (1925) and Volterra (1926): u̇ = u (a − b v), v̇ = v (d u − c), by steps
// of Runge and Kutta over 20 units of time. Unknown: the four rates and both populations at the
// start. Observed: both populations, in units of their typical size. A change of a rate changes the
// period, so the loss oscillates along it; no other problem here has cycles whose length is unknown
// and whose amplitude is kept.
#include "problems/calibration.h"
#include "problems/runge_kutta.h"

namespace isoline::problems {
namespace {

struct LotkaVolterra {
  Index samples = 20, refine = 1;
};
void fields(LotkaVolterra& o, auto& field) {
  field("samples", o.samples, between(4, 200), "observations of each population");
  field("refine", o.refine, between(1, 16), "steps of time for each step of 0.05");
}

struct Populations {
  Real dt;
  int steps;  // between observations

  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    std::array<Scalar, 2> s = {p[4], p[5]};
    const auto rate = [&](Real, const std::array<Scalar, 2>& of) {
      return std::array<Scalar, 2>{of[0] * (p[0] - p[1] * of[1]), of[1] * (p[3] * of[0] - p[2])};
    };
    for (int i = 0; i < m; i += 2) {
      s = after_steps(s, 0, dt, steps, rate);
      y[i] = s[0];
      y[i + 1] = s[1];
    }
  }
};

ProblemParts make_lotka_volterra(const LotkaVolterra& o, const Draw& draw) {
  constexpr Real kTime = 20, kStep = 0.05;
  const Real interval = kTime / static_cast<Real>(o.samples);
  const int steps = static_cast<int>(o.refine * static_cast<Index>(std::ceil(interval / kStep)));
  return calibration(Populations{interval / steps, steps}, 2 * o.samples,
                     {{"a", 0.6, -0.15},
                      {"b", 0.8, 0.1},
                      {"c", 0.8, 0.12},
                      {"d", 0.8, -0.1},
                      {"u0", 1.2, 0.2},
                      {"v0", 0.6, -0.2}},
                     0.2, draw);
}

}  // namespace

void register_lotka_volterra(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "lotka-volterra",
       .title = "Rates of predator and prey",
       .group = Group::physics,
       .formula = "u̇ = u (a − b v),  v̇ = v (d u − c),  P(x) = (u, v) at times up to 20",
       .source = "Lotka (1925); Volterra (1926); parameters near Howard (2009), scaled",
       .aim = Aim::x,
       .in_all = false},
      make_lotka_volterra));
}

}  // namespace isoline::problems
