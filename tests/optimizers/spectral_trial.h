// One spectral step of a problem by a way of one's choice.
#pragma once

#include <gtest/gtest.h>

#include "optimizers/spectral_step.h"
#include "run.h"
#include "trial_problems.h"

namespace isoline::optimizers {

// Three layers in double; `batch` samples of two outputs each make J wide up to 98.
inline Problem network(const std::string& batch, const std::string& activation = "tanh") {
  return published("sine[mode=learn,xi=2,network=mlp[layers=12-12,precision=double,activation=" +
                   activation + "],batch=" + batch + ",data=" + batch + "]");
}

inline constexpr OracleSet kAll{Oracle::forward, Oracle::jacobian, Oracle::pullback,
                                Oracle::pushforward, Oracle::layer_factors};

struct Computed {
  Vector step;  // −V f(σ) Uᵀ g
  std::string said;
  Real estimate = 0;  // of the error by a Gram matrix
};

inline Computed step_of(const Problem& problem, const Vector& theta, Way way,
                        const SpectralFilter& filter, const KrylovLimits& krylov = {},
                        const OracleSet& granted = kAll) {
  const auto trace = std::make_unique<Trace>();
  Meter meter(problem, iterations(10), granted, *trace);
  Vector start = theta;
  meter.begin(start);
  SpectralStep spectral(way, krylov);
  spectral.start(meter);
  Linearization at;
  meter.linearize(theta, at);
  Matrix g;
  at.cotangent(g);
  Vector step = Vector::Zero(theta.size());
  EXPECT_TRUE(spectral.add(meter, at, filter, g.reshaped(), -1, step));
  return {step, trace->claimed, spectral.error_by_gram()};
}

inline void expect_near(const Vector& one, const Vector& other, Real tolerance,
                        const std::string& what) {
  EXPECT_LE((one - other).norm(), tolerance * other.norm()) << what;
}

}  // namespace isoline::optimizers
