// A library of components that the examples do not cover: a problem with both products, one with
// forward alone, one that crashes, a method that solves in one call, and one that calls an
// undeclared oracle. The environment variable ISOLINE_DEFECT selects a defect of the first
// component.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "isoline.h"

static int is_wrong(const char* defect) {
  const char* wanted = getenv("ISOLINE_DEFECT");
  return wanted != NULL && strcmp(wanted, defect) == 0;
}

// P(x) = (x1², x1 x2, x2²), y* = (1, 2, 4): forward keeps 2 x.
static int dimension(void* self, isoline_sizes* sizes) {
  (void)self;
  sizes->inputs = is_wrong("no inputs") ? 0 : is_wrong("2^40 inputs") ? 1ULL << 40 : 2;
  sizes->outputs = is_wrong("no outputs") ? 0 : is_wrong("2^40 outputs") ? 1ULL << 40 : 3;
  sizes->kept = is_wrong("2^40 kept") ? 1ULL << 40 : 2;
  sizes->inverse = is_wrong("inverse of unknown kind") ? 9 : ISOLINE_EXACT;
  sizes->minimum = 0;
  static const double kLower[2] = {0, 0}, kUpper[2] = {0.5, 9};
  if (is_wrong("bounds")) sizes->lower = kLower, sizes->upper = kUpper;  // as they should be
  if (is_wrong("crossed bounds")) sizes->lower = kUpper, sizes->upper = kLower;
  return is_wrong("no dimension");
}

static int instance(void* self, double* start, double* target, double* truth) {
  (void)self, (void)truth;
  start[0] = start[1] = 3;
  target[0] = 1, target[1] = 2, target[2] = 4;
  return is_wrong("no instance");
}

static int forward(void* self, const double* x, double* y, double* kept) {
  (void)self;
  y[0] = x[0] * x[0], y[1] = x[0] * x[1], y[2] = x[1] * x[1];
  kept[0] = 2 * x[0], kept[1] = 2 * x[1];
  return is_wrong("no answer");
}

static int pushforward(void* self, const double* x, const double* kept, const double* v,
                       double* Jv) {
  (void)self;
  Jv[0] = kept[0] * v[0], Jv[1] = x[1] * v[0] + x[0] * v[1], Jv[2] = kept[1] * v[1];
  return 0;
}

static int pullback(void* self, const double* x, const double* kept, const double* u, double* JTu) {
  (void)self;
  JTu[0] = kept[0] * u[0] + x[1] * u[1], JTu[1] = x[0] * u[1] + kept[1] * u[2];
  return 0;
}

// Sound around the start, so that its certificate is good, and not on the way to the solution.
static int crash(void* self, const double* x, double* y, double* kept) {
  if (x[0] < 1.5) abort();
  return forward(self, x, y, kept);
}

static int no_inverse(void* self, const double* y, const double* x0, double* x) {
  (void)self, (void)y, (void)x0, (void)x;
  return 1;
}

// A whole solve: Gauss-Newton for two unknowns, each iteration reported.
static int solve(void* self, isoline_oracles* f, double* theta) {
  double loss, r[3], J[6], step[2];
  (void)self;
  if (f->unknowns != 2 || f->residuals != 3) return ISOLINE_FAILED;
  for (;;) {
    if (f->linearize(f, theta, &loss) || f->residual(f, r) || f->jacobian(f, J)) return 77;
    double a = 0, b = 0, c = 0, p = 0, q = 0;
    for (int i = 0; i < 3; ++i) {
      a += J[i] * J[i], b += J[i] * J[3 + i], c += J[3 + i] * J[3 + i];
      p += J[i] * r[i], q += J[3 + i] * r[i];
    }
    const double determinant = a * c - b * b;
    step[0] = (c * p - b * q) / determinant, step[1] = (a * q - b * p) / determinant;
    if (!(fabs(step[0]) + fabs(step[1]) > 1e-14)) return ISOLINE_CONVERGED;
    theta[0] -= step[0], theta[1] -= step[1];
    if (f->report(f, theta)) return 77;
  }
}

static int overreach(void* self, isoline_oracles* f, double* theta) {
  double loss, J[6];
  (void)self;
  if (is_wrong("gradient first")) return f->gradient(f, J) ? ISOLINE_FAILED : ISOLINE_RUNNING;
  if (is_wrong("unknown verdict")) return 7;
  if (is_wrong("failed step")) return ISOLINE_FAILED;
  if (f->linearize(f, theta, &loss) == 0) f->jacobian(f, J);  // and goes on as if it were there
  return ISOLINE_RUNNING;
}

// Declares that it respects bounds, and steps across them.
static int leave_bounds(void* self, isoline_oracles* f, double* theta) {
  double loss;
  (void)self;
  if (f->lower == NULL || f->upper[0] != 0.5 || f->lower[0] != 0) return ISOLINE_FAILED;
  if (is_wrong("bounds")) theta[0] = f->upper[0] + 1;
  return f->loss(f, theta, &loss) ? ISOLINE_STALLED : ISOLINE_RUNNING;
}

static const isoline_component kSound = {
    .version = ISOLINE_VERSION,
    .bytes = sizeof(isoline_component),
    .capabilities = ISOLINE_FORWARD | ISOLINE_PUSHFORWARD | ISOLINE_PULLBACK,
    .name = "trial-products",
    .title = "Products of two unknowns",
    .formula = "P(x) = (x₁², x₁ x₂, x₂²)",
    .source = "here",
    .dimension = dimension,
    .instance = instance,
    .forward = forward,
    .pushforward = pushforward,
    .pullback = pullback};

static isoline_component method(const char* name, uint64_t capabilities,
                                int (*step)(void*, isoline_oracles*, double*)) {
  isoline_component made = {.version = ISOLINE_VERSION, .bytes = sizeof made, .name = name};
  made.capabilities = capabilities;
  made.title = made.formula = made.source = "here";
  made.step = step;
  return made;
}

static void* open_nothing(const double* options, uint64_t seed) {
  (void)options, (void)seed;
  return NULL;
}

static void spoil(isoline_component* c) {
  static isoline_option outside = {.name = "size", .about = "n", .standard = 5, .high = 1};
  if (is_wrong("version")) c->version = 2;
  if (is_wrong("bytes")) c->bytes = 8;
  if (is_wrong("null name")) c->name = NULL;
  if (is_wrong("bad name")) c->name = "Trial[products]";
  if (is_wrong("empty title")) c->title = "";
  if (is_wrong("null source")) c->source = NULL;
  if (is_wrong("null dimension")) c->dimension = NULL;
  if (is_wrong("null instance")) c->instance = NULL;
  if (is_wrong("null forward")) c->forward = NULL;
  if (is_wrong("null pushforward")) c->pushforward = NULL;
  if (is_wrong("null pullback")) c->pullback = NULL;
  if (is_wrong("null jacobian")) c->capabilities |= ISOLINE_JACOBIAN;
  if (is_wrong("null inverse") || is_wrong("inverse of unknown kind"))
    c->capabilities |= ISOLINE_INVERSE;
  if (is_wrong("inverse of unknown kind")) c->inverse = no_inverse;
  if (is_wrong("bounds") || is_wrong("crossed bounds") || is_wrong("null bounds"))
    c->capabilities |= ISOLINE_BOUNDS;
  if (is_wrong("alien capability")) c->capabilities |= 1ULL << 40;
  if (is_wrong("no capability")) c->capabilities = 0;
  if (is_wrong("null step")) c->capabilities = ISOLINE_STEP;
  if (is_wrong("two kinds of step")) c->capabilities = ISOLINE_STEP | ISOLINE_SOLVE;
  if (is_wrong("null options")) c->option_count = 1;
  if (is_wrong("endless options")) c->option_count = 1ULL << 40;
  if (is_wrong("option outside")) c->options = &outside, c->option_count = 1;
  if (is_wrong("null instance of it")) c->open = open_nothing;
}

const isoline_component* isoline_plugin(uint64_t which) {
  static isoline_component made;
  if (is_wrong("crash at load")) abort();
  if (is_wrong("nothing at all")) return NULL;
  made = kSound;
  if (is_wrong("endless components")) return &made;
  switch (which) {
    case 0:
      spoil(&made);
      return &made;
    case 1:
      made.name = "trial-forward";
      made.capabilities = ISOLINE_FORWARD;
      return &made;
    case 2:
      made.name = "trial-crash";
      made.forward = crash;
      return &made;
    case 3:
      made = method("trial-solve", ISOLINE_SOLVE | ISOLINE_FORWARD | ISOLINE_JACOBIAN, solve);
      return &made;
    case 4:
      made = method("trial-overreach", ISOLINE_STEP | ISOLINE_FORWARD, overreach);
      return &made;
    case 5:
      made = method("trial-leaves-bounds", ISOLINE_STEP | ISOLINE_FORWARD | ISOLINE_BOUNDS,
                    leave_bounds);
      return &made;
    default:
      return NULL;
  }
}
