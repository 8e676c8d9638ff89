// My optimizer: v ← β v − η ∇L, θ ← θ + v. State the formula, its source, and any
// deviation from the source.
#include <stdlib.h>

#include "isoline.h"

typedef struct method {
  double rate, momentum;  // η, β
  double *v, *g;          // (n), and ∇L
} method;

static void* open_method(const double* options, uint64_t seed) {
  method* made = calloc(1, sizeof *made);
  (void)seed;
  if (made == NULL) return NULL;
  made->rate = options[0];
  made->momentum = options[1];
  return made;
}

static void close_method(void* self) {
  method* m = self;
  free(m->v);
  free(m->g);
  free(m);
}

static int start(void* self, isoline_oracles* f, const double* theta) {
  method* m = self;
  (void)theta;
  m->v = calloc(f->unknowns, sizeof *m->v);
  m->g = calloc(f->unknowns, sizeof *m->g);
  return m->v == NULL || m->g == NULL;
}

static int step(void* self, isoline_oracles* f, double* theta) {
  method* m = self;
  double loss;
  if (f->linearize(f, theta, &loss) || f->gradient(f, m->g)) return ISOLINE_FAILED;
  for (uint64_t i = 0; i < f->unknowns; ++i) {
    m->v[i] = m->momentum * m->v[i] - m->rate * m->g[i];
    theta[i] += m->v[i];
  }
  return ISOLINE_RUNNING;
}

const isoline_component* isoline_plugin(uint64_t which) {
  static const isoline_option options[] = {
      {.name = "rate", .about = "step length η", .standard = 1e-3, .high = 1e6, .is_tuned = 1},
      {.name = "momentum", .about = "share β of the last step", .standard = 0.9, .high = 1}};
  static const isoline_component mine = {
      .version = ISOLINE_VERSION,
      .bytes = sizeof(isoline_component),
      .capabilities = ISOLINE_STEP | ISOLINE_FORWARD | ISOLINE_PULLBACK,
      .name = "my-optimizer",
      .title = "My optimizer",
      .formula = "v ← β v − η ∇L,  θ ← θ + v",
      .source = "author (year), equation",
      .options = options,
      .option_count = 2,
      .open = open_method,
      .close = close_method,
      .start = start,
      .step = step};
  return which == 0 ? &mine : NULL;
}
