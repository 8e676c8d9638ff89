// Rosenbrock's valley in C: P(x) = (10 (x2 − x1²), 1 − x1), y* = 0. Moré, Garbow, Hillstrom (1981),
// problem 1. Gives the same runs as Isoline's `rosenbrock`.
#include <stddef.h>

#include "isoline.h"

static int dimension(void* self, isoline_sizes* sizes) {
  (void)self;
  sizes->inputs = sizes->outputs = 2;
  sizes->minimum = 0;
  sizes->inverse = ISOLINE_EXACT;
  return 0;
}

static int instance(void* self, double* start, double* target, double* truth) {
  (void)self;
  start[0] = -1.2, start[1] = 1;
  target[0] = target[1] = 0;
  truth[0] = truth[1] = 1;
  return 0;
}

static int forward(void* self, const double* x, double* y, double* kept) {
  (void)self, (void)kept;
  y[0] = 10 * (x[1] - x[0] * x[0]);
  y[1] = 1 - x[0];
  return 0;
}

static int jacobian(void* self, const double* x, const double* kept, double* J) {
  (void)self, (void)kept;
  J[0] = -20 * x[0], J[2] = 10;
  J[1] = -1, J[3] = 0;
  return 0;
}

static int inverse(void* self, const double* y, const double* x0, double* x) {
  (void)self, (void)x0;
  x[0] = 1 - y[1];
  x[1] = y[0] / 10 + x[0] * x[0];
  return 0;
}

const isoline_component* isoline_plugin(uint64_t which) {
  static const isoline_component valley = {
      .version = ISOLINE_VERSION,
      .bytes = sizeof(isoline_component),
      .capabilities = ISOLINE_FORWARD | ISOLINE_JACOBIAN | ISOLINE_INVERSE | ISOLINE_TRUTH,
      .name = "rosenbrock-c",
      .title = "Rosenbrock's valley, in C",
      .formula = "f = (10(x₂ − x₁²), 1 − x₁),  L = ½Σfᵢ²",
      .source = "Moré, Garbow, Hillstrom (1981), problem 1; Rosenbrock (1960)",
      .dimension = dimension,
      .instance = instance,
      .forward = forward,
      .jacobian = jacobian,
      .inverse = inverse};
  return which == 0 ? &valley : NULL;
}
