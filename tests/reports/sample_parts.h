// What the sample study is made of: methods, problems, and two-dimensional losses to descend.
#pragma once

#include <array>
#include <functional>

#include "core/array.h"
#include "core/records/sheet.h"

namespace isoline::reports {

struct Kind {
  const char* name;
  const char* family;
  Real speed;  // decades of loss per iteration, about
  int price;   // forwards per iteration
  bool is_privileged = false;
};
inline constexpr std::array<Kind, 33> kKinds = {{{"gd", "First order", 0.004, 2},
                                                 {"momentum", "First order", 0.01, 2},
                                                 {"nesterov", "First order", 0.012, 2},
                                                 {"adam", "First order", 0.02, 2},
                                                 {"adamw", "First order", 0.018, 2},
                                                 {"rmsprop", "First order", 0.009, 2},
                                                 {"adagrad", "First order", 0.005, 2},
                                                 {"lion", "First order", 0.008, 2},
                                                 {"soap", "First order", 0.05, 3},
                                                 {"muon", "First order", 0.03, 3},
                                                 {"lbfgs", "Quasi-Newton", 0.3, 2},
                                                 {"bfgs", "Quasi-Newton", 0.35, 2},
                                                 {"ceres-lbfgs", "Quasi-Newton", 0.28, 3},
                                                 {"nlopt-slsqp", "Quasi-Newton", 0.4, 3},
                                                 {"nlopt-mma", "Quasi-Newton", 0.1, 2},
                                                 {"gauss-newton", "Least squares", 0.8, 9},
                                                 {"levenberg-marquardt", "Least squares", 0.7, 9},
                                                 {"ceres-lm", "Least squares", 0.75, 9},
                                                 {"ceres-dogleg", "Least squares", 0.7, 9},
                                                 {"hig", "Half-inverse", 0.25, 9},
                                                 {"hig[beta=0.2]", "Half-inverse", 0.2, 9},
                                                 {"newton", "Second order", 1.1, 14, true},
                                                 {"newton-cg", "Second order", 0.6, 20},
                                                 {"adahessian", "Second order", 0.05, 6},
                                                 {"sip", "Scale-invariant", 0.9, 3, true},
                                                 {"sip[step=0.3]", "Scale-invariant", 0.3, 3, true},
                                                 {"nelder-mead", "Derivative-free", 0.02, 2},
                                                 {"cma-es", "Derivative-free", 0.015, 12},
                                                 {"bobyqa", "Derivative-free", 0.05, 1},
                                                 {"cobyla", "Derivative-free", 0.03, 1},
                                                 {"subplex", "Derivative-free", 0.02, 2},
                                                 {"random-search", "Derivative-free", 0.001, 1},
                                                 {"broken", "First order", 0.01, 2}}};
inline constexpr std::array kProblems = {
    "square",        "sine[xi=32,phi=45]", "rosenbrock",     "poisson", "heat",
    "oscillators",   "oscillators[n=2]",   "quantum-dipole", "chain",   "fluid",
    "sine",          "rosenbrock[n=10]",   "wave[steps=64]", "lens",    "burgers",
    "heat[grid=128]"};

struct Surface {
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> map;  // y = P(x), y* = 0
  Landscape in_x, in_y;
};

Surface surface(bool is_sine);

// As if measured; no two problems alike.
MeasuredPrices sample_prices(std::size_t problem);

// One step of a descent whose direction is a blend of gradient and Newton, by the method's speed.
void descend(const Surface& surface, const Kind& kind, Eigen::Vector2d& x);

}  // namespace isoline::reports
