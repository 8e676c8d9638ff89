// Calibrations: a model with a few positive parameters pᵢ = p̄ᵢ exp(xᵢ), p̄ᵢ typical values, from
// which every run starts. The data are exact, and x* is known.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "problems/jet_physics.h"

namespace isoline::problems {

// The model f(p, n, y, m) as a function of x.
template <class Model>
struct OfLogarithms {
  Model model;
  std::vector<Real> typical;

  template <class Scalar>
  void operator()(const Scalar* x, int n, Scalar* y, int m) const {
    thread_local std::vector<Scalar> p;  // no allocation once it is warm
    p.resize(static_cast<std::size_t>(n));
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = typical[i] * exp(x[i]);
    model(p.data(), n, y, m);
  }
};

// With the derivatives by all parameters from one evaluation. It offers no second derivatives.
template <class Model>
class Calibration final : public DensePhysics {
 public:
  Calibration(OfLogarithms<Model> model, Index n, Index m)
      : DensePhysics(n, m), model_(std::move(model)) {}
  void value(VectorRef x, VectorOut y) const override {
    model_(x.data(), static_cast<int>(inputs()), y.data(), static_cast<int>(outputs()));
  }
  void derivative(VectorRef x, BatchOut J) const override {
    thread_local std::vector<First> in, out;
    in.assign(x.begin(), x.end());
    out.resize(static_cast<std::size_t>(outputs()));
    for (Index j = 0; j < inputs(); ++j) in[j].by[j] = 1;
    model_(in.data(), static_cast<int>(inputs()), out.data(), static_cast<int>(outputs()));
    for (Index i = 0; i < outputs(); ++i)
      for (Index j = 0; j < inputs(); ++j) J(i, j) = out[i].by[j];
  }

 private:
  OfLogarithms<Model> model_;
};

struct Parameter {
  std::string name;    // of p, whose logarithm is unknown
  Real typical = 1;    // p̄
  Real published = 0;  // x* of the published instance
};

// Other instances have x* uniform in ±spread.
template <class Model>
ProblemParts calibration(Model model, Index m, const std::vector<Parameter>& parameters,
                         Real spread, const Draw& draw) {
  const auto n = static_cast<Index>(parameters.size());
  OfLogarithms<Model> of_x{std::move(model), {}};
  Vector truth = draw.stream("target").uniform_vector(n, -spread, spread);
  std::vector<std::string> names;
  for (Index i = 0; i < n; ++i) {
    const Parameter& parameter = parameters[static_cast<std::size_t>(i)];
    of_x.typical.push_back(parameter.typical);
    names.push_back("ln " + parameter.name);
    if (draw.is_published()) truth[i] = parameter.published;
  }
  Matrix target(m, 1);
  of_x(truth.data(), static_cast<int>(n), target.data(), static_cast<int>(m));
  return {.physics = std::make_unique<Calibration<Model>>(std::move(of_x), n, m),
          .start = draw.start(Vector::Zero(n), StartScale::at_least_one),
          .target = target,
          .minimum = 0,
          .truth = truth,
          .names = std::move(names)};
}

}  // namespace isoline::problems
