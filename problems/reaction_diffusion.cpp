// Growth that spreads, Fisher (1937), Kolmogorov, Petrovsky, Piskunov (1937): u_t = D u_ss + r(s) u
// (1 − u) on (0, 1) without flux through the ends, on N cells, by steps of Runge and Kutta over 8
// units of time. Unknown: D, and r at equidistant nodes, linear in between. Observed: u in all
// cells at four times. A front visits the nodes one after the other: what lies ahead of it is not
// visible yet. A partial differential equation that generates its front, unlike those that carry
// one.
#include "problems/calibration.h"
#include "problems/runge_kutta.h"

namespace isoline::problems {
namespace {

constexpr std::size_t kMostCells = 32;
constexpr int kTimes = 4;

struct ReactionDiffusion {
  Index nodes = 5, refine = 1;
};
void fields(ReactionDiffusion& o, auto& field) {
  field("nodes", o.nodes, between(2, 11), "nodes of the growth rate");
  field("refine", o.refine, between(1, 16), "steps of time for each step of 0.1");
}

struct Front {
  int steps;  // between two of the four times
  Real dt;

  template <class Scalar>
  void operator()(const Scalar* p, int n, Scalar* y, int) const {
    constexpr Real kCells = kMostCells, kFoot = 0.1;
    const int nodes = n - 1;
    std::array<Scalar, kMostCells> u, growth;
    for (std::size_t i = 0; i < kMostCells; ++i) {
      const Real s = (static_cast<Real>(i) + 0.5) / kCells, at = s * (nodes - 1);
      const int left = std::min(static_cast<int>(at), nodes - 2);
      growth[i] = p[1 + left] * (left + 1 - at) + p[2 + left] * (at - left);
      u[i] = Scalar(0.8 * std::exp(-s * s / (2 * kFoot * kFoot)));
    }
    const Scalar spread = p[0] * (kCells * kCells);
    const auto rate = [&](Real, const std::array<Scalar, kMostCells>& of) {
      std::array<Scalar, kMostCells> r;
      for (std::size_t i = 0; i < kMostCells; ++i) {
        const Scalar &left = of[i == 0 ? 0 : i - 1], &right = of[std::min(i + 1, kMostCells - 1)];
        r[i] = spread * (left - 2.0 * of[i] + right) + growth[i] * of[i] * (1.0 - of[i]);
      }
      return r;
    };
    for (int time = 0; time < kTimes; ++time) {
      u = after_steps(u, 0, dt, steps, rate);
      y = std::copy(u.begin(), u.end(), y);
    }
  }
};

ProblemParts make_reaction_diffusion(const ReactionDiffusion& o, const Draw& draw) {
  constexpr Real kInterval = 2;
  const int steps = static_cast<int>(20 * o.refine);
  std::vector<Parameter> parameters = {{"D", 3e-3, 0.2}};
  for (Index i = 0; i < o.nodes; ++i)
    parameters.push_back({"r" + std::to_string(i + 1), 1, i % 2 == 0 ? 0.3 : -0.3});
  return calibration(Front{steps, kInterval / steps}, static_cast<Index>(kMostCells) * kTimes,
                     parameters, 0.4, draw);
}

}  // namespace

void register_reaction_diffusion(ProblemRegistry& registry) {
  registry.add(
      problem_entry({.name = "reaction-diffusion",
                     .title = "Growth rate behind a front",
                     .group = Group::physics,
                     .formula = "u_t = D u_ss + r(s) u (1 − u),  P(x) = u at four times",
                     .source = "Fisher (1937), equation 1; Kolmogorov, Petrovsky, Piskunov (1937)",
                     .aim = Aim::x,
                     .in_all = false},
                    make_reaction_diffusion));
}

}  // namespace isoline::problems
