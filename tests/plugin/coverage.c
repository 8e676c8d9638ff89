// Two models as engineers fit them, whose seeds are data sets with other noise: an exponential
// decay with an offset, and Michaelis-Menten kinetics. With bounded=1, an offset of 0 is fitted
// above 0; with printed=6, y has six significant digits, as many programs print it.
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "isoline.h"

enum { DECAY_DATA = 20, KINETICS_DATA = 24, MOST_DATA = 24 };

typedef struct model {
  int is_kinetics, is_bounded, digits;
  uint64_t state;
  double lower[3], upper[3];
} model;

static int unknowns(const model* m) { return m->is_kinetics && !m->is_bounded ? 2 : 3; }
static int data(const model* m) { return m->is_kinetics ? KINETICS_DATA : DECAY_DATA; }

static void truth_of(const model* m, double* x) {
  x[0] = m->is_kinetics ? 210 : 5;
  x[1] = m->is_kinetics ? 65 : 0.9;
  x[2] = m->is_bounded ? 0 : 1;
}

static double value(const model* m, const double* x, int i) {
  static const double kPpb[6] = {20, 60, 110, 220, 560, 1100};  // as Treloar (1974)
  const double offset = unknowns(m) == 3 ? x[2] : 0;
  if (m->is_kinetics) return offset + x[0] * kPpb[i % 6] / (x[1] + kPpb[i % 6]);
  return offset + x[0] * exp(-x[1] * 0.25 * i);
}

static double printed(const model* m, double y) {
  char text[64];
  if (m->digits == 0) return y;
  snprintf(text, sizeof text, "%.*g", m->digits, y);
  return strtod(text, NULL);
}

static double uniform(model* m) {  // splitmix64; Steele, Lea, Flood (2014)
  uint64_t z = m->state += 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return ((double)((z ^ (z >> 31)) >> 11) + 0.5) / 9007199254740992.0;
}

static model* open_model(const double* options, uint64_t seed, int is_kinetics) {
  model* m = calloc(1, sizeof *m);
  if (m == NULL) return NULL;
  m->is_kinetics = is_kinetics;
  m->is_bounded = options[0] > 0, m->digits = (int)options[1];
  m->state = 1000003 * (seed + 1) + (uint64_t)is_kinetics;
  for (int i = 0; i < 3; ++i) m->lower[i] = i == 2 && !m->is_bounded ? -HUGE_VAL : 0;
  for (int i = 0; i < 3; ++i) m->upper[i] = HUGE_VAL;
  return m;
}
static void* open_decay(const double* options, uint64_t seed) {
  return open_model(options, seed, 0);
}
static void* open_kinetics(const double* options, uint64_t seed) {
  return open_model(options, seed, 1);
}

static int dimension(void* self, isoline_sizes* sizes) {
  model* m = self;
  sizes->inputs = (uint64_t)unknowns(m), sizes->outputs = (uint64_t)data(m);
  sizes->lower = m->lower, sizes->upper = m->upper;
  return 0;
}

static int instance(void* self, double* start, double* target, double* truth) {
  model* m = self;
  double x[3];
  (void)truth;
  truth_of(m, x);
  for (int i = 0; i < unknowns(m); ++i) start[i] = 1.3 * x[i] + (i == 2 ? 0.5 : 0);
  for (int i = 0; i < data(m); ++i) {
    const double radius = sqrt(-2 * log(uniform(m)));  // Box, Muller (1958)
    target[i] = value(m, x, i) +
                (m->is_kinetics ? 10 : 0.15) * radius * cos(6.283185307179586 * uniform(m));
  }
  return 0;
}

static int forward(void* self, const double* x, double* y, double* kept) {
  const model* m = self;
  (void)kept;
  for (int i = 0; i < data(m); ++i) y[i] = printed(m, value(m, x, i));
  return 0;
}

const isoline_component* isoline_plugin(uint64_t which) {
  static const isoline_option kOptions[2] = {
      {.name = "bounded", .about = "1: an offset of 0, fitted above 0", .low = 0, .high = 1},
      {.name = "printed", .about = "significant digits of y; 0: all", .low = 0, .high = 17}};
  static isoline_component made[2];
  if (which > 1) return NULL;
  made[which] =
      (isoline_component){.version = ISOLINE_VERSION,
                          .bytes = sizeof(isoline_component),
                          .capabilities = ISOLINE_FORWARD | ISOLINE_BOUNDS,
                          .name = which ? "covered-kinetics" : "covered-decay",
                          .title = which ? "Michaelis-Menten kinetics" : "Decay",
                          .formula = which ? "y = a s/(b + s) + c" : "y = a exp(-b t) + c",
                          .source = "here",
                          .options = kOptions,
                          .option_count = 2,
                          .open = which ? open_kinetics : open_decay,
                          .close = free,
                          .dimension = dimension,
                          .instance = instance,
                          .forward = forward};
  return &made[which];
}
