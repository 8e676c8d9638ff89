// The oscillator of van der Pol (1926): ü = μ (1 − u²) u̇ − ω² u, by steps of Runge and Kutta over
// 12 units of time. Unknown: μ, ω and the state at the start. Observed: u. All paths approach one
// limit cycle, so the start shows in a few observations alone while its phase shows in all.
#include "problems/calibration.h"
#include "problems/runge_kutta.h"

namespace isoline::problems {
namespace {

struct VanDerPol {
  Index samples = 24, refine = 1;
};
void fields(VanDerPol& o, auto& field) {
  field("samples", o.samples, between(6, 200), "observations");
  field("refine", o.refine, between(1, 16), "steps of time for each step of 0.025");
}

struct Oscillation {
  Real dt;
  int steps;  // between observations

  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    std::array<Scalar, 2> s = {p[2], p[3]};
    const auto rate = [&](Real, const std::array<Scalar, 2>& of) {
      return std::array<Scalar, 2>{of[1],
                                   p[0] * (1.0 - of[0] * of[0]) * of[1] - p[1] * p[1] * of[0]};
    };
    for (int i = 0; i < m; ++i) {
      s = after_steps(s, 0, dt, steps, rate);
      y[i] = s[0];
    }
  }
};

ProblemParts make_van_der_pol(const VanDerPol& o, const Draw& draw) {
  constexpr Real kTime = 12, kStep = 0.025;
  const Real interval = kTime / static_cast<Real>(o.samples);
  const int steps = static_cast<int>(o.refine * static_cast<Index>(std::ceil(interval / kStep)));
  return calibration(Oscillation{interval / steps, steps}, o.samples,
                     {{"μ", 1.5, 0.2}, {"ω", 1, 0.05}, {"u0", 1, 0.3}, {"v0", 1, -0.4}}, 0.3, draw);
}

}  // namespace

void register_van_der_pol(ProblemRegistry& registry) {
  registry.add(problem_entry({.name = "van-der-pol",
                              .title = "Relaxation oscillator",
                              .group = Group::physics,
                              .formula = "ü = μ (1 − u²) u̇ − ω² u,  P(x) = u at times up to 12",
                              .source = "van der Pol (1926), equation 1",
                              .aim = Aim::x,
                              .in_all = false},
                             make_van_der_pol));
}

}  // namespace isoline::problems
