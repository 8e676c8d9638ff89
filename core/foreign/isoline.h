// Problems and optimizers for Isoline in C, or in any language that has C's calling convention. A
// shared library exports one function, isoline_plugin(). `isoline run --plugin ./libmine.so` then
// knows its components by their names, and so does every other verb with --plugin.
//
// Numbers are doubles, and matrices are stored column by column. A function returns 0, or another
// value if it has no answer: its output then counts as NaN. It must not keep pointers from its
// arguments. Calls are not concurrent; each run has its own process.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { ISOLINE_VERSION = 1 };

// The functions of a problem, and the oracles that an optimizer calls.
enum {
  ISOLINE_FORWARD = 1 << 0,      // y = P(x)
  ISOLINE_PUSHFORWARD = 1 << 1,  // J v
  ISOLINE_PULLBACK = 1 << 2,     // Jᵀ u
  ISOLINE_JACOBIAN = 1 << 3,     // J, (m, k)
  ISOLINE_INVERSE = 1 << 4,      // an x near x0 with P(x) = y
  ISOLINE_TRUTH = 1 << 5,        // only of a problem: the x* that produced the target
  ISOLINE_BOUNDS = 1 << 6,       // a problem has bounds, by dimension(); an optimizer respects them
  ISOLINE_STEP = 1 << 8,         // only of an optimizer: step() is one iteration,
  ISOLINE_SOLVE = 1 << 9,        // or the complete solve, which reports each iteration itself
  ISOLINE_COMPARES = 1 << 10     // in addition: it compares losses of different steps
};

// The kind of an inverse.
enum { ISOLINE_EXACT = 1, ISOLINE_DAMPED, ISOLINE_ESTIMATE, ISOLINE_APPROXIMATE };

// The values that step() returns.
enum { ISOLINE_RUNNING = 0, ISOLINE_CONVERGED, ISOLINE_STALLED, ISOLINE_FAILED };

// A number that a user may set: `mine[rate=0.1]`.
typedef struct isoline_option {
  const char *name, *about;
  double standard, low, high;  // its default, and its valid range
  uint32_t is_tuned;           // of an optimizer: `isoline tune` chooses this one
} isoline_option;

// The sizes of an instance. Initially all are 0, and `minimum` is NaN.
typedef struct isoline_sizes {
  uint64_t inputs, outputs;  // k, m
  uint64_t kept;             // doubles that forward() stores for the products at the same x
  double minimum;            // the least attainable loss, if known
  uint32_t inverse;          // ISOLINE_EXACT, …, if there is an inverse
  // With ISOLINE_BOUNDS: k numbers each, which stay valid until close(); infinite where there is no
  // bound. Methods that do not respect bounds do not apply.
  const double *lower, *upper;
} isoline_sizes;

// The problem as an optimizer sees it: r = (y − y*)/√B over its B samples, J = ∂r/∂θ, and y*. The
// functions return 0, or another value if the run is over: step() must then return at once, with
// any value. All except loss() and report() refer to the θ that was linearized last.
typedef struct isoline_oracles isoline_oracles;
struct isoline_oracles {
  uint64_t unknowns, residuals;  // n, m
  const double* target;          // y*, (m)
  int (*linearize)(isoline_oracles* f, const double* theta, double* loss);
  int (*loss)(isoline_oracles* f, const double* theta, double* loss);  // of a trial
  int (*gradient)(isoline_oracles* f, double* g);                      // ∇L, (n): a pullback
  int (*residual)(isoline_oracles* f, double* r);                      // (m)
  int (*pushforward)(isoline_oracles* f, const double* v, double* Jv);
  int (*pullback)(isoline_oracles* f, const double* u, double* JTu);
  int (*jacobian)(isoline_oracles* f, double* J);  // (m, n)
  int (*inverse)(isoline_oracles* f, const double* y, double* x);
  int (*report)(isoline_oracles* f,
                const double* theta);  // for ISOLINE_SOLVE: the end of an iteration
  // With ISOLINE_BOUNDS: bounds on θ, (n) each, infinite where there is no bound; NULL if the
  // problem has none. The run fails if θ is outside them in any call or after step().
  const double *lower, *upper;
};

// A problem or an optimizer. Functions outside its capabilities may be NULL, and so may `note`,
// `open`, `close` and `start`.
typedef struct isoline_component {
  uint32_t version, bytes;  // ISOLINE_VERSION, sizeof(isoline_component)
  uint64_t capabilities;    // ISOLINE_FORWARD | …
  const char* name;         // lower-case letters, digits and hyphens
  const char *title, *formula, *source, *note;
  const isoline_option* options;
  uint64_t option_count;

  // Creates an instance, which every function below receives as `self`. `options` are in the order
  // above; seed 0 is the published instance of a problem, and the seed of an optimizer. NULL means
  // failure.
  void* (*open)(const double* options, uint64_t seed);
  void (*close)(void* self);

  // A problem: ISOLINE_FORWARD and its derivatives. Missing products follow from the Jacobian.
  // Without derivatives, only methods that need none apply. `truth` is NULL unless ISOLINE_TRUTH is
  // set. Seeds other than 0 start near `start`, as Isoline samples it.
  int (*dimension)(void* self, isoline_sizes* sizes);
  int (*instance)(void* self, double* start, double* target, double* truth);  // (k), (m), (k)
  int (*forward)(void* self, const double* x, double* y, double* kept);
  int (*pushforward)(void* self, const double* x, const double* kept, const double* v, double* Jv);
  int (*pullback)(void* self, const double* x, const double* kept, const double* u, double* JTu);
  int (*jacobian)(void* self, const double* x, const double* kept, double* J);
  int (*inverse)(void* self, const double* y, const double* x0, double* x);

  // An optimizer: ISOLINE_STEP or ISOLINE_SOLVE, and the oracles that it calls. step() moves θ,
  // (n).
  int (*start)(void* self, isoline_oracles* f, const double* theta);
  int (*step)(void* self, isoline_oracles* f, double* theta);
} isoline_component;

// The function that a library exports: its components by number, from 0; NULL after the last.
const isoline_component* isoline_plugin(uint64_t which);

#ifdef __cplusplus
}
#endif
