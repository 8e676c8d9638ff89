// The logarithm of the viscosity of a lubricant over shear rates and temperatures, by the law of
// Carreau and Yasuda with an Arrhenius shift a_T = exp(E (1/T − 1/T₀)):
//
//   η = η_∞ + (η₀ a_T − η_∞) (1 + (λ a_T γ̇)^a)^(−s/a),  s = 1 − n.
//
// Yasuda, Armstrong, Cohen (1981), equation 2. Unknown: η₀, η_∞, λ, a, s, E. A curve with two
// plateaus on logarithmic axes; only the bend between them separates λ, a and s.
#include "problems/calibration.h"

namespace isoline::problems {
namespace {

constexpr std::array kKelvin = {303.15, 313.15, 323.15};

struct Lubricant {
  Index samples = 10;
};
void fields(Lubricant& o, auto& field) {
  field("samples", o.samples, between(4, 200), "shear rates from 1e4 to 1e11, at each temperature");
}

struct Viscosity {
  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    constexpr Real kReference = 313.15;
    const int rates = m / static_cast<int>(kKelvin.size());
    for (const Real kelvin : kKelvin) {
      const Scalar shift = exp(p[5] * (1000 / kelvin - 1000 / kReference));  // E in 1000 K
      for (int i = 0; i < rates; ++i) {
        const Real shear = 1e-3 * std::pow(1e7, static_cast<Real>(i) / (rates - 1));  // in 1e7/s
        const Scalar bend = 1.0 + pow(p[2] * shift * shear, p[3]);
        *y++ = log(p[1] + (p[0] * shift - p[1]) * pow(bend, -p[4] / p[3]));
      }
    }
  }
};

ProblemParts make_lubricant(const Lubricant& o, const Draw& draw) {
  return calibration(Viscosity{}, static_cast<Index>(kKelvin.size()) * o.samples,
                     {{"η0", 80, 0.2},
                      {"η∞", 1, 0.3},
                      {"λ", 2, -0.4},
                      {"a", 1.5, 0.2},
                      {"1 − n", 0.5, 0.15},
                      {"E", 3, 0.2}},
                     0.4, draw);
}

}  // namespace

void register_lubricant(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "lubricant",
       .title = "Viscosity of a lubricant",
       .group = Group::physics,
       .formula =
           "P(x) = ln(η_∞ + (η₀ a_T − η_∞)(1 + (λ a_T γ̇)^a)^(−s/a)),  a_T = exp(E (1/T − 1/T₀))",
       .source = "Yasuda, Armstrong, Cohen (1981), equation 2",
       .note = "Viscosities in mPa s, λ in 1e-7 s, E in 1000 K.",
       .aim = Aim::x,
       .in_all = false},
      make_lubricant));
}

}  // namespace isoline::problems
