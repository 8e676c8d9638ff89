// An epidemic, Kermack and McKendrick (1927): Ṡ = −β S I, İ = β S I − γ I, as shares of a
// population, by steps of Runge and Kutta over 15 days. Unknown: β, γ, the infected at the start
// and the share of the infected that is counted. Observed: the counted share of I. A single wave
// that grows exponentially at first: its unknowns are visible one after the other, as no cycle
// shows them.
#include "problems/calibration.h"
#include "problems/runge_kutta.h"

namespace isoline::problems {
namespace {

struct Sir {
  Index samples = 15, refine = 1;
};
void fields(Sir& o, auto& field) {
  field("samples", o.samples, between(4, 200), "observations");
  field("refine", o.refine, between(1, 16), "steps of time for each step of a tenth of a day");
}

struct Epidemic {
  Real dt;
  int steps;  // between observations

  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    std::array<Scalar, 2> s = {1.0 - p[2], p[2]};
    const auto rate = [&](Real, const std::array<Scalar, 2>& of) {
      const Scalar infections = p[0] * of[0] * of[1];
      return std::array<Scalar, 2>{-infections, infections - p[1] * of[1]};
    };
    for (int i = 0; i < m; ++i) {
      s = after_steps(s, 0, dt, steps, rate);
      y[i] = p[3] * s[1];
    }
  }
};

ProblemParts make_sir(const Sir& o, const Draw& draw) {
  constexpr Real kDays = 15, kStep = 0.1;
  const Real interval = kDays / static_cast<Real>(o.samples);
  const int steps = static_cast<int>(o.refine * static_cast<Index>(std::ceil(interval / kStep)));
  return calibration(Epidemic{interval / steps, steps}, o.samples,
                     {{"β", 1.5, 0.11}, {"γ", 0.5, -0.12}, {"I0", 5e-3, -0.6}, {"share", 0.7, 0.2}},
                     0.4, draw);
}

}  // namespace

void register_sir(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "sir",
       .title = "Rates of an epidemic",
       .group = Group::physics,
       .formula = "Ṡ = −β S I,  İ = β S I − γ I,  P(x) = share · I at times up to 15 days",
       .source = "Kermack, McKendrick (1927); rates near British Medical Journal, 4 March 1978",
       .aim = Aim::x,
       .in_all = false},
      make_sir));
}

}  // namespace isoline::problems
