// A problem from its spec, as the command line makes it.
#pragma once

#include <numbers>

#include "core/spec.h"
#include "problems/problem.h"

namespace isoline::problems {

inline constexpr Real kPi = std::numbers::pi;

inline const ProblemRegistry& all_problems() {
  static const ProblemRegistry registry = [] {
    ProblemRegistry filled("problem");
    register_problems(filled);
    return filled;
  }();
  return registry;
}

inline Problem make(const std::string& text, std::uint64_t seed = 0) {
  const Spec spec = parse_spec(text);
  const ProblemEntry& entry = all_problems().at(spec.name);
  return entry.make(complete_options(entry.options, entry.name, options_of(spec)),
                    Draw(seed, entry.name));
}

inline Real loss_at(const Problem& problem, const Vector& theta) {
  Point at;
  problem.forward(theta, at);
  return at.loss;
}

inline Real loss_at_start(const Problem& problem) { return loss_at(problem, problem.start()); }

inline Vector gradient_at(const Problem& problem, const Vector& theta) {
  Point at;
  Matrix g(problem.outputs(), problem.samples());
  Vector gradient(problem.unknowns());
  problem.forward(theta, at);
  problem.cotangent(at, g);
  problem.pullback(g, gradient, at);
  return gradient;
}

inline Matrix jacobian_at(const Problem& problem, const Vector& theta) {
  Point at;
  Matrix J;
  problem.forward(theta, at);
  problem.jacobian(J, at);
  return J;
}

}  // namespace isoline::problems
