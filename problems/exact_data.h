// The problem of finding an x* again from its exact data, y* = P(x*), with 0 as the standard start.
#pragma once

#include <memory>
#include <utility>

#include "problems/problem.h"

namespace isoline::problems {

// x* (k), of physics that are one to one: the error is ‖x − x*‖. Both x and y are fields.
inline ProblemParts from_exact_data(std::unique_ptr<Physics> physics, const Vector& truth,
                                    const Field& field, const Draw& draw) {
  Workspace w;
  Matrix target(physics->outputs(), 1);
  physics->forward(truth, Matrix(0, 1), target, w);
  return {.physics = std::move(physics),
          .start = draw.start(Vector::Zero(truth.size())),
          .target = target,
          .minimum = 0,
          .truth = truth,
          .x_error = [truth](BatchRef x, const Batch&) { return (x - truth).norm(); },
          .field = field};
}

}  // namespace isoline::problems
