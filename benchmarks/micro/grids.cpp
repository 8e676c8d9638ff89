// A forward pass and a pullback of the grid problems over the fastest FFTW transforms known for
// them, which for Poisson's are real ones of the odd extensions of all lines, and over the sine
// transforms of both dimensions that FFTW offers. FFTW is called without its adapter on purpose:
// the adapter is part of what is measured.
#include <fftw3.h>
#include <fmt/format.h>

#include <complex>

#include "benchmarks/micro/pairs.h"
#include "core/fourier.h"
#include "core/random.h"
#include "problems/physics/flow_physics.h"
#include "problems/physics/flow_step.h"

namespace isoline::benchmarks::micro {

using problems::draw_flow;
using problems::FlowOptions;
using problems::FlowRun;
using problems::FlowSample;
using problems::Simulation;
namespace {

enum class Bare { fourier, odd_lines, sines };

// There and back again, twice.
struct BareTransforms {
  Vector grid;                // (N²), or of one line's extension
  Eigen::VectorXcd spectrum;  // room for either kind of spectrum
  fftw_plan there = nullptr, back = nullptr;
  int lines = 1;

  BareTransforms(int N, Bare kind)
      : grid(Vector::Ones(Index{N} * N)), spectrum(Eigen::VectorXcd::Zero((Index{N} / 2 + 2) * N)) {
    constexpr unsigned kThere = FFTW_ESTIMATE | FFTW_PRESERVE_INPUT;
    auto* const complex = reinterpret_cast<fftw_complex*>(spectrum.data());
    auto* const real = reinterpret_cast<double*>(spectrum.data());
    switch (kind) {
      case Bare::fourier:
        there = fftw_plan_dft_r2c_2d(N, N, grid.data(), complex, kThere);
        back = fftw_plan_dft_c2r_2d(N, N, complex, grid.data(), FFTW_ESTIMATE);
        break;
      case Bare::odd_lines:
        there = fftw_plan_dft_r2c_1d(2 * (N + 1), grid.data(), complex, kThere);
        back = fftw_plan_dft_r2c_1d(2 * (N + 1), grid.data(), complex, kThere);
        lines = N;
        break;
      case Bare::sines:
        there = fftw_plan_r2r_2d(N, N, grid.data(), real, FFTW_RODFT00, FFTW_RODFT00, kThere);
        back = fftw_plan_r2r_2d(N, N, real, grid.data(), FFTW_RODFT00, FFTW_RODFT00, kThere);
        break;
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
      for (int pass = 0; pass < 2 * lines; ++pass) {
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

// A step of the flow on 64×64 cells over what it cannot do without: the two transforms of its
// projection and one pass through the memory of each field. And the adjoint over the forward step.

constexpr Index kN = 64, kSteps = 8;

struct BarePasses {
  RealFourier2d fourier{kN, kN};
  Matrix from = Matrix::Ones(kN * kN, 3), to = from;

  Cost run() {
    return cost_of(1, [this] {
      for (Index step = 0; step < kSteps; ++step) {
        fourier.forward(from.col(0));
        fourier.inverse(to.col(0));
        to = 0.5 * from;
      }
    });
  }
};

struct Flow {
  Simulation simulation{FlowOptions{}, kSteps};
  FlowRun run;
  Vector cotangent, moved;  // (3N²)

  Flow() {
    RandomStream stream(0, "navier-stokes", "benchmark");
    const FlowSample sample = draw_flow(kN, 2, stream);
    simulation.begin(sample.velocity, sample.marker, run);
    cotangent = stream.normal_vector(3 * kN * kN);
  }
  Cost forward() {
    return cost_of(1, [this] { simulation.forward(run); });
  }
  Cost both() {
    return cost_of(1, [this] {
      simulation.forward(run);
      moved = cotangent;
      simulation.pullback(run, moved);
    });
  }
};

}  // namespace

void register_grids() {
  struct Bench {
    const char* problem;
    Bare bare;
    const char* over;
    Goal small, large;  // at N = 64 and 512
  };
  const Bench benches[] = {
      {"poisson", Bare::odd_lines, "", {.ratio = 1.6}, {.ratio = 1.6}},
      {"poisson", Bare::sines, "/RODFT00", {.ratio = 0.45}, {.ratio = 0.75}},
      {"heat", Bare::fourier, "", {.ratio = 1.3}, {.ratio = 1.3}},
  };
  for (const int N : {64, 512}) {
    for (const Bench& bench : benches) {
      const std::string spec = fmt::format("{}[N={}]", bench.problem, N);
      const Goal& goal = N < 100 ? bench.small : bench.large;
      register_pair("transforms/" + spec + bench.over, N < 100 ? 1001 : 61, goal,
                    [=, kind = bench.bare] {
                      const auto solves = std::make_shared<Solves>(spec);
                      const auto bare = std::make_shared<BareTransforms>(N, kind);
                      return Pair{[=] { return solves->run(); }, [=] { return bare->run(); }};
                    });
    }
  }
  constexpr int kPairs = 301;
  register_pair("fluid/8 steps over transforms and passes", kPairs, {.ratio = 3}, [] {
    const auto flow = std::make_shared<Flow>();
    const auto bare = std::make_shared<BarePasses>();
    return Pair{[flow] { return flow->forward(); }, [bare] { return bare->run(); }};
  });
  register_pair("fluid/8 steps and their adjoint over 8 steps", kPairs, {.ratio = 4}, [] {
    const auto flow = std::make_shared<Flow>(), other = std::make_shared<Flow>();
    return Pair{[flow] { return flow->both(); }, [other] { return other->forward(); }};
  });
}

}  // namespace isoline::benchmarks::micro
