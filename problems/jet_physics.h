// Physics by a formula that is written once for every scalar: its Jacobian and its second
// derivatives are those of jets.
#pragma once

#include <algorithm>
#include <vector>

#include "problems/dense_physics.h"
#include "problems/jet.h"

namespace isoline::problems {

inline constexpr int kJetLanes = 12;  // unknowns whose derivatives one evaluation gives
using First = Jet<Real, kJetLanes>;
using Second = Jet<First, kJetLanes>;

// F: f(x, n, y, m) on arrays of Real, First and Second.
template <class F>
class JetPhysics : public DensePhysics {
 public:
  JetPhysics(F f, Index n, Index m) : DensePhysics(n, m), f_(std::move(f)) {}
  void value(VectorRef x, VectorOut y) const override { f_(x.data(), n(), y.data(), m()); }
  void derivative(VectorRef x, BatchOut J) const override {
    thread_local std::vector<First> in, out;
    in.assign(x.begin(), x.end());
    out.resize(m());
    for (int first = 0; first < n(); first += kJetLanes) {
      const int lanes = std::min(kJetLanes, n() - first);
      for (int j = 0; j < n(); ++j) in[j].by.fill(0);
      for (int j = 0; j < lanes; ++j) in[first + j].by[j] = 1;
      f_(in.data(), n(), out.data(), m());
      for (int i = 0; i < m(); ++i)
        for (int j = 0; j < lanes; ++j) J(i, first + j) = out[i].by[j];
    }
  }
  bool has_curvature() const override { return n() <= kJetLanes; }
  void second(VectorRef x, VectorRef u, BatchOut H) const override {
    thread_local std::vector<Second> in, out;
    in.assign(x.begin(), x.end());
    out.resize(m());
    for (int j = 0; j < n(); ++j) in[j].by[j] = in[j].value.by[j] = 1;
    f_(in.data(), n(), out.data(), m());
    for (int i = 0; i < m(); ++i)
      for (int j = 0; j < n(); ++j)
        for (int k = 0; k < n(); ++k) H(j, k) += u[i] * out[i].by[j].by[k];
  }

 private:
  int n() const { return static_cast<int>(inputs()); }
  int m() const { return static_cast<int>(outputs()); }
  F f_;
};

// A formula without data of its own, as a lambda f(auto x, int n, auto y, int m).
struct JetFunction {
  void (*value)(const Real* x, int n, Real* y, int m);
  void (*first)(const First* x, int n, First* y, int m);
  void (*second)(const Second* x, int n, Second* y, int m);

  void operator()(const Real* x, int n, Real* y, int m) const { value(x, n, y, m); }
  void operator()(const First* x, int n, First* y, int m) const { first(x, n, y, m); }
  void operator()(const Second* x, int n, Second* y, int m) const { second(x, n, y, m); }
};
template <class F>
constexpr JetFunction jet_function(F) {
  return {[](const Real* x, int n, Real* y, int m) { F{}(x, n, y, m); },
          [](const First* x, int n, First* y, int m) { F{}(x, n, y, m); },
          [](const Second* x, int n, Second* y, int m) { F{}(x, n, y, m); }};
}

}  // namespace isoline::problems
