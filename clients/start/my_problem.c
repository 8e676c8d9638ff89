// My problem: P(x) = (x1 + c x2², x2 + c x1²), y* = P(1/2, −1/2). State the formula, its
// source, and any deviation from the source.
#include <stddef.h>
#include <stdlib.h>

#include "isoline.h"

// An instance. If seeds other than 0 have other instances, open() samples them.
typedef struct problem {
  double coupling;  // c
} problem;

static void* open_problem(const double* options, uint64_t seed) {
  problem* made = malloc(sizeof *made);
  (void)seed;
  if (made != NULL) made->coupling = options[0];
  return made;
}

static int dimension(void* self, isoline_sizes* sizes) {
  (void)self;
  sizes->inputs = sizes->outputs = 2;
  sizes->minimum = 0;
  return 0;
}

// Computes y. May store up to `kept` doubles, as dimension() declares, for the products below.
static int forward(void* self, const double* x, double* y, double* kept) {
  const double c = ((const problem*)self)->coupling;
  (void)kept;
  y[0] = x[0] + c * x[1] * x[1];
  y[1] = x[1] + c * x[0] * x[0];
  return 0;
}

static int pushforward(void* self, const double* x, const double* kept, const double* v,
                       double* Jv) {
  const double c = ((const problem*)self)->coupling;
  (void)kept;
  Jv[0] = v[0] + 2 * c * x[1] * v[1];
  Jv[1] = v[1] + 2 * c * x[0] * v[0];
  return 0;
}

static int pullback(void* self, const double* x, const double* kept, const double* u, double* JTu) {
  const double c = ((const problem*)self)->coupling;
  (void)kept;
  JTu[0] = u[0] + 2 * c * x[0] * u[1];
  JTu[1] = u[1] + 2 * c * x[1] * u[0];
  return 0;
}

static int instance(void* self, double* start, double* target, double* truth) {
  start[0] = start[1] = 1;
  truth[0] = 0.5, truth[1] = -0.5;
  return forward(self, truth, target, NULL);
}

const isoline_component* isoline_plugin(uint64_t which) {
  static const isoline_option coupling = {
      .name = "coupling", .about = "c", .standard = 0.25, .low = 0, .high = 1};
  static const isoline_component mine = {
      .version = ISOLINE_VERSION,
      .bytes = sizeof(isoline_component),
      .capabilities = ISOLINE_FORWARD | ISOLINE_PUSHFORWARD | ISOLINE_PULLBACK | ISOLINE_TRUTH,
      .name = "my-problem",
      .title = "My problem",
      .formula = "P(x) = (x₁ + c x₂², x₂ + c x₁²)",
      .source = "author (year), equation",
      .options = &coupling,
      .option_count = 1,
      .open = open_problem,
      .close = free,
      .dimension = dimension,
      .instance = instance,
      .forward = forward,
      .pushforward = pushforward,
      .pullback = pullback};
  return which == 0 ? &mine : NULL;
}
