// Thermal isomerization of α-pinene: ẏ₁ = −(θ₁ + θ₂) y₁, ẏ₂ = θ₁ y₁, ẏ₃ = θ₂ y₁ − (θ₃ + θ₄) y₃ + θ₅
// y₅, ẏ₄ = θ₃ y₃, ẏ₅ = θ₄ y₃ − θ₅ y₅, in percent over 36,420 s, by steps of Runge and Kutta.
// Unknown: the five rates. Observed: all five species, in parts of a hundred. Box, Hunter,
// MacGregor, Erjavec (1973); the data are exact here. Each rate shows as a slow, monotone exchange
// between species.
#include "problems/calibration.h"
#include "problems/runge_kutta.h"

namespace isoline::problems {
namespace {

struct AlphaPinene {
  Index samples = 8, refine = 1;
};
void fields(AlphaPinene& o, auto& field) {
  field("samples", o.samples, between(2, 100), "times of observation");
  field("refine", o.refine, between(1, 16), "steps of time for each step of a hundredth");
}

struct Isomerization {
  Real dt;
  int steps;  // between observations

  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    std::array<Scalar, 5> s = {Scalar(1), Scalar(0), Scalar(0), Scalar(0), Scalar(0)};
    const auto rate = [&](Real, const std::array<Scalar, 5>& of) {
      const Scalar back = p[3] * of[2] - p[4] * of[4];
      return std::array<Scalar, 5>{-(p[0] + p[1]) * of[0], p[0] * of[0],
                                   p[1] * of[0] - p[2] * of[2] - back, p[2] * of[2], back};
    };
    for (int i = 0; i < m; i += 5) {
      s = after_steps(s, 0, dt, steps, rate);
      std::copy(s.begin(), s.end(), y + i);
    }
  }
};

ProblemParts make_alpha_pinene(const AlphaPinene& o, const Draw& draw) {
  constexpr Real kDuration = 3.642, kStep = 0.01;  // in units of 10⁴ s
  const Real interval = kDuration / static_cast<Real>(o.samples);
  const int steps = static_cast<int>(o.refine * static_cast<Index>(std::ceil(interval / kStep)));
  return calibration(
      Isomerization{interval / steps, steps}, 5 * o.samples,
      {{"θ1", 1, -0.52}, {"θ2", 1, -1.22}, {"θ3", 1, -1.59}, {"θ4", 1, 1.01}, {"θ5", 1, -0.92}}, 1,
      draw);
}

}  // namespace

void register_alpha_pinene(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "alpha-pinene",
       .title = "Isomerization of α-pinene",
       .group = Group::physics,
       .formula = "ẏ = A(θ) y,  P(x) = y at times up to 36,420 s",
       .source = "Box, Hunter, MacGregor, Erjavec (1973)",
       .note = "Rates in units of 1e-4 per second; x* of the published instance is the best fit.",
       .aim = Aim::x,
       .in_all = false},
      make_alpha_pinene));
}

}  // namespace isoline::problems
