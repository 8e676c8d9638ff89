// A drug in two compartments after an oral dose: gut ġ = −kₐ g, centre V₁ ċ = kₐ g − CL c − Q (c −
// p), periphery V₂ ṗ = Q (c − p), by steps of Runge and Kutta over 24 hours. Unknown: kₐ, CL, V₁,
// Q, V₂. Observed: the concentration c, more often at first. Linear in time and nonlinear in its
// unknowns: a sum of three exponentials whose rates are functions of five unknowns.
#include "problems/calibration.h"
#include "problems/runge_kutta.h"

namespace isoline::problems {
namespace {

struct TwoCompartments {
  Index samples = 12, refine = 1;
};
void fields(TwoCompartments& o, auto& field) {
  field("samples", o.samples, between(6, 200), "observations");
  field("refine", o.refine, between(1, 16), "steps of time for each step of a tenth of an hour");
}

struct Concentration {
  Index refine;

  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    constexpr Real kDose = 10, kHours = 24, kStep = 0.1;
    const Scalar &absorbed = p[0], &clearance = p[1], &centre = p[2], &flow = p[3], &outer = p[4];
    std::array<Scalar, 3> s = {Scalar(kDose), Scalar(0), Scalar(0)};
    const auto rate = [&](Real, const std::array<Scalar, 3>& of) {
      const Scalar entering = absorbed * of[0], exchanged = flow * (of[1] - of[2]);
      return std::array<Scalar, 3>{-entering, (entering - clearance * of[1] - exchanged) / centre,
                                   exchanged / outer};
    };
    Real t = 0;
    for (int i = 0; i < m; ++i) {  // at the squares of equal distances
      const Real share = static_cast<Real>(i + 1) / m, next = kHours * share * share;
      const int steps = static_cast<int>(refine) * static_cast<int>(std::ceil((next - t) / kStep));
      s = after_steps(s, t, (next - t) / steps, steps, rate);
      y[i] = s[1];
      t = next;
    }
  }
};

ProblemParts make_two_compartments(const TwoCompartments& o, const Draw& draw) {
  return calibration(
      Concentration{o.refine}, o.samples,
      {{"ka", 1.2, 0.25}, {"CL", 1.5, -0.3}, {"V1", 5, 0.2}, {"Q", 2, 0.35}, {"V2", 12, -0.25}},
      0.4, draw);
}

}  // namespace

void register_two_compartments(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "two-compartments",
       .title = "A drug in two compartments",
       .group = Group::physics,
       .formula = "ġ = −kₐ g,  V₁ ċ = kₐ g − CL c − Q (c − p),  V₂ ṗ = Q (c − p),  P(x) = c",
       .source = "Gibaldi, Perrier (1982), Pharmacokinetics, chapter 2",
       .aim = Aim::x,
       .in_all = false},
      make_two_compartments));
}

}  // namespace isoline::problems
