// The logarithm of the response of a machine on a mount to a force of unit amplitude at given
// frequencies ω: masses m₁ and m₂, the lower on the ground by a spring k₁ and a damper c₁, the
// upper on the lower by k₂ and c₂,
//
//   (k₁ + k₂ − ω² m₁ + iω (c₁ + c₂)) u₁ − (k₂ + iω c₂) u₂ = 0,  −(k₂ + iω c₂) u₁ + (k₂ − ω² m₂ + iω
//   c₂) u₂ = 1,  y = ½ ln |u₂|².
//
// Den Hartog (1934), chapter 3. Unknown: all six. Two resonances: where a trial has one at another
// frequency than the data, the loss is nearly flat along it.
#include "problems/calibration.h"

namespace isoline::problems {
namespace {

struct MachineMount {
  Index samples = 30;
};
void fields(MachineMount& o, auto& field) {
  field("samples", o.samples, between(6, 500), "frequencies from 0.2 to 4");
}

struct Response {
  template <class Scalar>
  void operator()(const Scalar* p, int, Scalar* y, int m) const {
    const Scalar &m1 = p[0], &c1 = p[1], &k1 = p[2], &m2 = p[3], &c2 = p[4], &k2 = p[5];
    for (int i = 0; i < m; ++i) {
      const Real w = 0.2 * std::pow(20.0, static_cast<Real>(i) / (m - 1));
      // a = lower stiffness, b = coupling, d = upper stiffness; u₂ = a/(a d − b²).
      const Scalar ar = k1 + k2 - w * w * m1, ai = w * (c1 + c2), bi = w * c2, dr = k2 - w * w * m2;
      const Scalar real = ar * dr - ai * bi - (k2 * k2 - bi * bi);
      const Scalar imaginary = ar * bi + ai * dr - 2.0 * k2 * bi;
      y[i] = 0.5 * (log(ar * ar + ai * ai) - log(real * real + imaginary * imaginary));
    }
  }
};

ProblemParts make_machine_mount(const MachineMount& o, const Draw& draw) {
  return calibration(Response{}, o.samples,
                     {{"m1", 1, 0.15},
                      {"c1", 0.15, 0.3},
                      {"k1", 1, -0.15},
                      {"m2", 0.5, -0.1},
                      {"c2", 0.1, -0.3},
                      {"k2", 1, 0.15}},
                     0.2, draw);
}

}  // namespace

void register_machine_mount(ProblemRegistry& registry) {
  registry.add(problem_entry({.name = "machine-mount",
                              .title = "Response of a machine on a mount",
                              .group = Group::physics,
                              .formula = "(K + iω C − ω² M) u = (0, 1),  P(x) = ln |u₂(ω)|",
                              .source = "Den Hartog (1934), Mechanical Vibrations, chapter 3",
                              .aim = Aim::x,
                              .in_all = false},
                             make_machine_mount));
}

}  // namespace isoline::problems
