// Water in soil, van Genuchten (1980), equations 3 and 8: with S = (1 + (α h)ⁿ)^(−m), m = 1 − 1/n,
// the water content θ_r + (θ_s − θ_r) S and the logarithm of the conductivity K_s √S (1 − (1 −
// S^(1/m))^m)² at suctions h. Unknown: θ_r, θ_s, α, n − 1, K_s. Explicit formulas of two kinds of
// data that share α and n: powers of powers, nearly flat where the soil is wet.
#include "problems/calibration.h"

namespace isoline::problems {
namespace {

struct Soil {
  Index samples = 10;
};
void fields(Soil& o, auto& field) {
  field("samples", o.samples, between(4, 200), "suctions from 0.03 to 100 m, of either kind");
}

struct Retention {
  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    const Scalar n = 1.0 + p[3], power = p[3] / n;  // m = 1 − 1/n
    for (int i = 0; i < m / 2; ++i) {
      const Real suction = 0.03 * std::pow(100 / 0.03, static_cast<Real>(i) / (m / 2 - 1));
      const Scalar wet = 1.0 / (1.0 + pow(p[2] * suction, n));  // S^(1/m)
      const Scalar saturation = pow(wet, power);
      y[i] = p[0] + (p[1] - p[0]) * saturation;
      y[m / 2 + i] =
          0.1 * (log(p[4]) + 0.5 * log(saturation) + 2.0 * log(1.0 - pow(1.0 - wet, power)));
    }
  }
};

ProblemParts make_soil(const Soil& o, const Draw& draw) {
  return calibration(Retention{}, 2 * o.samples,
                     {{"θr", 0.06, 0.3},
                      {"θs", 0.45, -0.05},
                      {"α", 2, 0.55},
                      {"n − 1", 0.8, -0.35},
                      {"Ks", 0.25, 0.2}},
                     0.4, draw);
}

}  // namespace

void register_soil(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "soil",
       .title = "Retention and conductivity of a soil",
       .group = Group::physics,
       .formula = "S = (1 + (α h)ⁿ)^(−m),  P(x) = (θ_r + (θ_s − θ_r) S, ln(K_s √S (1 − (1 − "
                  "S^(1/m))^m)²)/10)",
       .source = "van Genuchten (1980), equations 3 and 8; Mualem (1976)",
       .note = "K_s is in metres per day.",
       .aim = Aim::x,
       .in_all = false},
      make_soil));
}

}  // namespace isoline::problems
