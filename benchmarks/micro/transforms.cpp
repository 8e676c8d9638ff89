// A forward pass and a pullback of the grid problems over the four FFTW transforms they consist of.
// FFTW is called past its door on purpose: the door is part of what is measured.
#include <fftw3.h>
#include <fmt/format.h>

#include <complex>

#include "benchmarks/micro/pairs.h"
#include "benchmarks/micro/trial.h"

namespace isoline::benchmarks::micro {
namespace {

// There and back again, twice.
struct BareTransforms {
  Vector grid;                // (N²)
  Eigen::VectorXcd spectrum;  // room for either kind of spectrum
  fftw_plan there = nullptr, back = nullptr;

  BareTransforms(int N, bool is_sine)
      : grid(Vector::Ones(N * N)), spectrum(Eigen::VectorXcd::Zero((N / 2 + 1) * N)) {
    constexpr unsigned kThere = FFTW_ESTIMATE | FFTW_PRESERVE_INPUT;
    auto* const complex = reinterpret_cast<fftw_complex*>(spectrum.data());
    auto* const real = reinterpret_cast<double*>(spectrum.data());
    if (is_sine) {
      there = fftw_plan_r2r_2d(N, N, grid.data(), real, FFTW_RODFT00, FFTW_RODFT00, kThere);
      back = fftw_plan_r2r_2d(N, N, real, grid.data(), FFTW_RODFT00, FFTW_RODFT00, kThere);
    } else {
      there = fftw_plan_dft_r2c_2d(N, N, grid.data(), complex, kThere);
      back = fftw_plan_dft_c2r_2d(N, N, complex, grid.data(), FFTW_ESTIMATE);
    }
  }
  BareTransforms(const BareTransforms&) = delete;
  BareTransforms& operator=(const BareTransforms&) = delete;
  ~BareTransforms() {
    fftw_destroy_plan(there);
    fftw_destroy_plan(back);
  }

  Cost run() {
    grid.setOnes();  // unnormalized, they would overflow
    return cost_of(1, [this] {
      for (int pass = 0; pass < 2; ++pass) {
        fftw_execute(there);
        fftw_execute(back);
      }
    });
  }
};

struct Solves {
  explicit Solves(const std::string& spec)
      : problem(make_problem(spec)),
        theta(problem.start()),
        gradient(problem.unknowns()),
        g(problem.outputs(), problem.samples()) {}

  const Problem problem;
  Vector theta, gradient;
  Matrix g;
  Point at;

  Cost run() {
    return cost_of(1, [this] {
      problem.forward(theta, at);
      problem.cotangent(at, g);
      problem.pullback(g, gradient, at);
    });
  }
};

}  // namespace

void register_transforms() {
  for (const int N : {64, 512}) {
    for (const std::string name : {"poisson", "heat"}) {
      const std::string spec = fmt::format("{}[N={}]", name, N);
      register_pair("transforms/" + spec, N < 100 ? 1001 : 61, {.ratio = 1.3}, [=] {
        const auto solves = std::make_shared<Solves>(spec);
        const auto bare = std::make_shared<BareTransforms>(N, name == "poisson");
        return Pair{[=] { return solves->run(); }, [=] { return bare->run(); }};
      });
    }
  }
}

}  // namespace isoline::benchmarks::micro
