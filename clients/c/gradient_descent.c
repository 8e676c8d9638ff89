// Steepest descent in C: θ ← θ − η ∇L, projected onto the bounds of a problem. Cauchy (1847). Gives
// the same runs as Isoline's `gd`.
#include <stdlib.h>

#include "isoline.h"

typedef struct descent {
  double rate;
  double* g;  // (n), ∇L
} descent;

static void* open_descent(const double* options, uint64_t seed) {
  (void)seed;
  descent* made = calloc(1, sizeof *made);
  if (made != NULL) made->rate = options[0];
  return made;
}

static void close_descent(void* self) {
  descent* of = self;
  free(of->g);
  free(of);
}

static int start(void* self, isoline_oracles* f, const double* theta) {
  descent* of = self;
  (void)theta;
  of->g = calloc(f->unknowns, sizeof *of->g);
  return of->g == NULL;
}

static int step(void* self, isoline_oracles* f, double* theta) {
  descent* of = self;
  double loss;
  if (f->linearize(f, theta, &loss) || f->gradient(f, of->g)) return ISOLINE_FAILED;
  for (uint64_t i = 0; i < f->unknowns; ++i) theta[i] -= of->rate * of->g[i];
  for (uint64_t i = 0; f->lower != NULL && i < f->unknowns; ++i) {
    if (theta[i] < f->lower[i]) theta[i] = f->lower[i];
    if (theta[i] > f->upper[i]) theta[i] = f->upper[i];
  }
  return ISOLINE_RUNNING;
}

const isoline_component* isoline_plugin(uint64_t which) {
  static const isoline_option rate = {
      .name = "rate", .about = "step length η", .standard = 1e-2, .high = 1e6, .is_tuned = 1};
  static const isoline_component gd = {
      .version = ISOLINE_VERSION,
      .bytes = sizeof(isoline_component),
      .capabilities = ISOLINE_STEP | ISOLINE_FORWARD | ISOLINE_PULLBACK | ISOLINE_BOUNDS,
      .name = "gd-c",
      .title = "Gradient descent, in C",
      .formula = "θ ← θ − η ∇L",
      .source = "Cauchy (1847)",
      .options = &rate,
      .option_count = 1,
      .open = open_descent,
      .close = close_descent,
      .start = start,
      .step = step};
  return which == 0 ? &gd : NULL;
}
