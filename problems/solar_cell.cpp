// The current I of a solar cell at given voltages V, by the single-diode model
//
//   I = I_L − I_0 (exp((V + I R_s)/(a V_t)) − 1) − (V + I R_s)/R_p,
//
// an equation for I that Newton's method solves from the right of its root, where it is monotone.
// Unknown: I_L, I_0, a, R_s, R_p. Easwarakhanthan et al. (1986). Implicit: each observation is the
// root of an equation of its own, and I_0 and a compensate each other over five decades.
#include "problems/calibration.h"

namespace isoline::problems {
namespace {

struct SolarCell {
  Index samples = 26;
};
void fields(SolarCell& o, auto& field) {
  field("samples", o.samples, between(6, 500), "voltages, from −0.2 to 0.59 V");
}

template <class T>
Real plain(const T& value) {
  if constexpr (std::is_same_v<T, Real>)
    return value;
  else
    return plain(value.value);
}

struct Diode {
  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    constexpr Real kThermal = 8.617333262e-5 * 306.15;  // V_t at 33 °C
    constexpr int kMost = 100,
                  kAfter = 1;  // steps after convergence give the derivatives
    for (int i = 0; i < m; ++i) {
      const Real volt = -0.2 + 0.79 * i / (m - 1);
      const Scalar thermal = p[2] * kThermal;
      Scalar current = p[0] + std::abs(volt) / p[4];
      int after = 0;
      for (int step = 0; step < kMost && after <= kAfter; ++step) {
        const Scalar drop = volt + current * p[3], diode = p[1] * exp(drop / thermal);
        const Scalar move = (p[0] - diode + p[1] - drop / p[4] - current) /
                            (1.0 + diode * p[3] / thermal + p[3] / p[4]);
        current += move;
        after += std::abs(plain(move)) < 1e-13;
      }
      y[i] = current;
    }
  }
};

ProblemParts make_solar_cell(const SolarCell& o, const Draw& draw) {
  return calibration(Diode{}, o.samples,
                     {{"IL", 0.8, -0.05},
                      {"I0", 4e-7, -0.25},
                      {"a", 1.5, -0.015},
                      {"Rs", 0.035, 0.04},
                      {"Rp", 50, 0.07}},
                     0.1, draw);
}

}  // namespace

void register_solar_cell(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "solar-cell",
       .title = "Parameters of a solar cell",
       .group = Group::physics,
       .formula = "I = I_L − I₀ (exp((V + I R_s)/(a V_t)) − 1) − (V + I R_s)/R_p,  P(x) = I(V)",
       .source = "Easwarakhanthan, Bottin, Bouhouch, Boutrit (1986)",
       .note = "The published instance is near the fit of the 57 mm cell of R.T.C. France.",
       .aim = Aim::x,
       .in_all = false},
      make_solar_cell));
}

}  // namespace isoline::problems
