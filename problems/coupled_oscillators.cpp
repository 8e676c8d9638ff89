// The nonlinear coupled oscillators of Schnell, Holl, Thuerey (2022), published scripts: two masses
// on springs of their own, coupled by the cube of their distance, one of them pushed,
//
//   ẋ = v,  v̇₁ = −x₁ + (x₂ − x₁)³,  v̇₂ = −x₂ − (x₂ − x₁)³ + 3u(t),
//
// over 96 Runge-Kutta steps of 0.125 in each of which u is constant. They shall return to where
// they began. The scripts' network rectifies (ReLU), the book's is of hyperbolic tangents.
#include "problems/oscillators.h"

namespace isoline::problems {
namespace {

struct Options {
  ReturnOptions common{
      .learning = {.network = "mlp[layers=20-20-20,activation=relu,precision=double,init=glorot]",
                   .batch = 128}};
};
void fields(Options& o, auto& field) { fields(o.common, field); }

ProblemParts make_coupled_oscillators(const Options& o, const Draw& draw) {
  constexpr Forces kForces{.linear = 0, .cubic = 1, .gain = 3};
  return return_to_start(o.common, std::make_unique<Oscillators>(kForces, 96, 0.125), draw);
}

}  // namespace

void register_coupled_oscillators(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "coupled-oscillators",
       .title = "Coupled oscillators",
       .group = Group::physics,
       .formula = "ẍ₁ = −x₁ + (x₂ − x₁)³,  ẍ₂ = −x₂ − (x₂ − x₁)³ + 3u(t),  y* = the initial state",
       .source = "Schnell, Holl, Thuerey (2022), published scripts",
       .note = "Published as a learning problem, with the loss ‖y − y*‖², loss=square here; by "
               "default half of that, so that 2η here equals η there. mode=direct finds "
               "the 96 controls of one initial state. The network is the scripts'; the book's has "
               "activation=tanh.",
       .aim = Aim::loss,  // any control that returns will do
       .in_all = false,
       .panels = {{.title = "Fig. 2b: learning curves", .kind = "curve"},
                  {.title = "Saturated neurons", .kind = "series", .quantity = "saturated neurons"},
                  {.title = "Path of the first sample",
                   .kind = "path",
                   .quantity = "x1 of the first sample|x2 of the first sample"}}},
      make_coupled_oscillators));
}

}  // namespace isoline::problems
