// One step of half-inverse gradients over LAPACK's thin SVD of the same Jacobian alone, by the same
// kernels in the same run: at the start, and where a hundred steps have led. The step includes the
// forward pass and everything that J or its Gram matrix takes. At the published cut-offs the
// spectra of these problems reach below 1e-5 of the largest, so that the default is by a split Gram
// matrix, and for the chain by QR, which agree with the SVD to 1e-9; way=layers differs from it by
// up to 1e-5 there, as a SVD in single precision does.
#include <lapacke.h>

#include "benchmarks/micro/pairs.h"

namespace isoline::benchmarks::micro {

using problems::Point;
namespace {

struct Bench {
  const char* problem;
  const char* method;
  double ratio;  // promised
};
const Bench kBenches[] = {
    {"linear-chain[mode=learn,batch=32]", "hig[rate=2,cutoff=1e-10]", 1.0 / 2},
    {"coupled-oscillators[mode=learn,batch=128]", "hig[rate=2]", 1.0 / 5},
    {"coupled-oscillators[mode=learn,batch=128]", "hig[rate=2,way=layers]", 1.0 / 5},
    {"quantum-dipole[mode=learn,batch=16]", "hig[rate=0.5,cutoff=1e-5]", 1.0 / 10},
    {"quantum-dipole[mode=learn,batch=16]", "hig[rate=0.5,cutoff=1e-5,way=layers]", 1.0 / 10},
};

Vector after(const Problem& problem, const std::string& method, int steps) {
  const auto trial = std::make_unique<Trial>(problem, method, endless());
  Vector theta = problem.start();
  trial->meter.begin(theta);
  trial->method->start(trial->meter, theta);
  for (int i = 0; i < steps; ++i) {
    trial->method->step(trial->meter, theta);
    trial->meter.iterate(theta);
  }
  return theta;
}

// A method that is asked for the same step again and again.
struct Still {
  Still(const Problem& problem, const std::string& spec, const Vector& at)
      : trial(problem, spec, endless()), theta(at) {
    trial.meter.begin(theta);
    trial.method->start(trial.meter, theta);
  }
  Cost run() {
    moved = theta;
    return cost_of(1, [this] { trial.method->step(trial.meter, moved); });
  }

  Trial trial;
  Vector theta, moved;  // (n)
};

// As numpy.linalg.svd and the published scripts have it.
Cost thin_svd_of(const Matrix& J) {
  const auto m = static_cast<lapack_int>(J.rows()), n = static_cast<lapack_int>(J.cols());
  const lapack_int r = std::min(m, n);
  Matrix scratch = J, U(m, r), Vt(r, n);
  Vector sigma(r);
  return cost_of(1, [&] {
    LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', m, n, scratch.data(), m, sigma.data(), U.data(), m,
                   Vt.data(), r);
  });
}

Pair make(const Bench& bench, int steps) {
  const auto problem = std::make_shared<const Problem>(make_problem(bench.problem));
  const Vector theta = after(*problem, bench.method, steps);
  const auto still = std::make_shared<Still>(*problem, bench.method, theta);
  Point at;
  problem->forward(theta, at);
  const auto J = std::make_shared<Matrix>();
  problem->jacobian(*J, at);
  return {[problem, still] { return still->run(); }, [=] { return thin_svd_of(*J); }};
}

}  // namespace

void register_spectral() {
  for (const Bench& bench : kBenches)
    for (const int steps : {0, 100}) {
      const std::string name = std::string("spectral/") + bench.method + "/" + bench.problem +
                               (steps > 0 ? "/after 100 steps" : "/start");
      register_pair(name, 5, {.ratio = bench.ratio}, [=] { return make(bench, steps); });
    }
}

}  // namespace isoline::benchmarks::micro
