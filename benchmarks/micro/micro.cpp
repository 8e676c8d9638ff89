// Micro-benchmarks: each function of ours is timed in turn with the bare computation that it wraps,
// so noise affects both. Figures are medians over pairs: `ns` a call of ours, `bare_ns`, their
// `ratio` and difference `extra_ns`. Choose by --benchmark_filter=metering. The bare side calls the
// libraries without the adapters of the other modules.
#include <benchmark/benchmark.h>
#include <cblas.h>
#include <ceres/ceres.h>
#include <fftw3.h>
#include <fmt/format.h>
#include <glog/logging.h>
#include <lapacke.h>
#include <nlopt.h>

#include <algorithm>
#include <complex>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/execute.h"
#include "core/clock.h"
#include "core/foreign/handshake.h"
#include "core/spec.h"
#include "core/threads.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"

namespace isoline::benchmarks::micro {

using Eigen::Map;
using optimizers::Linearization;
using problems::Block;
namespace {

// The mean seconds of a call.
template <class Work>
double seconds_of(int calls, Work&& work) {
  const std::uint64_t begin = ticks();
  for (int i = 0; i < calls; ++i) work();
  const auto elapsed = static_cast<double>(ticks() - begin);
  return elapsed * seconds_per_tick() / calls;
}

struct Pair {
  std::function<double()> ours, bare;  // seconds of a call
};

// The promised ratio; 0 without a promise.
struct Goal {
  double ratio = 0, extra_ns = 0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

void compare(benchmark::State& state, const Pair& pair, const Goal& goal) {
  std::vector<double> ours, bare, ratio, extra;  // ns, but for the ratio
  pair.ours();                                   // warm
  pair.bare();
  bool ours_first = true;
  for (auto _ : state) {
    double a = ours_first ? pair.ours() : 0;
    const double b = pair.bare();
    if (!ours_first) a = pair.ours();
    ours_first = !ours_first;
    state.SetIterationTime(a);
    ours.push_back(1e9 * a);
    bare.push_back(1e9 * b);
    ratio.push_back(a / b);
    extra.push_back(1e9 * (a - b));
  }
  state.counters["ns"] = median(ours);
  state.counters["bare_ns"] = median(bare);
  state.counters["ratio"] = median(ratio);
  state.counters["extra_ns"] = median(extra);
  if (goal.ratio > 0) state.counters["goal_ratio"] = goal.ratio;
  if (goal.extra_ns > 0) state.counters["goal_extra_ns"] = goal.extra_ns;
}

// `make` prepares a pair when its benchmark is chosen; it is then run `pairs` times.
void register_pair(const std::string& name, int pairs, const Goal& goal,
                   const std::function<Pair()>& make) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) { compare(state, make(), goal); })
      ->Iterations(pairs)
      ->UseManualTime();
}

const Catalog& catalog() {
  static const Catalog all = builtin_catalog();
  return all;
}

Problem make_problem(const std::string& text) {
  return benchmarks::make_problem(catalog(), complete_problem(catalog(), parse_spec(text)), 0);
}

// Iterations without end unless given, so that nothing but the method decides.
Budget endless(std::int64_t iterations = std::numeric_limits<std::int64_t>::max()) {
  return {.iterations = iterations, .target = 0};
}

// A method under way on a problem that outlives it.
struct Trial {
  Trial(const Problem& f, const std::string& spec, const Budget& budget)
      : Trial(f, complete_optimizer(catalog(), parse_spec(spec)), budget) {}
  Trial(const Problem& f, const Component& of, const Budget& budget)
      : problem(f),
        method(catalog().optimizers.at(of.name).make(of.options, catalog().optimizers)),
        meter(f, budget, needs_of(catalog().optimizers.at(of.name), of.options, f), trace) {}

  const Problem& problem;
  Trace trace;
  std::unique_ptr<Optimizer> method;
  Meter meter;
};

// --- counting and tracing in an evaluation of a tiny problem, over the bare call

constexpr int kMeteredCalls = 1000;

struct Metered {
  explicit Metered(const Budget& budget)
      : problem(make_problem("scaling")),
        meter(problem, budget, {Oracle::forward}, trace),
        theta(problem.start()) {
    meter.begin(theta);
    for (int i = 0; i < kMeteredCalls * kMeteredCalls; ++i) meter.iterate(theta);  // past the dense
  }

  const Problem problem;
  Trace trace;
  Meter meter;
  Vector theta;
  Linearization at;
  Point point;
};

void register_metering() {
  Budget with_clock = endless();
  with_clock.seconds = 1e6;
  struct Bench {
    const char* name;
    Budget budget;
    double extra_ns;  // promised
    void (*call)(Metered& f);
  };
  const Bench benches[] = {
      {"loss", endless(), 5, [](Metered& f) { f.meter.loss(f.theta); }},
      {"linearize", endless(), 5, [](Metered& f) { f.meter.linearize(f.theta, f.at); }},
      {"loss-clock", with_clock, 15, [](Metered& f) {
         f.meter.loss(f.theta);
         f.meter.is_spent();
       }}};
  for (const Bench& bench : benches)
    register_pair(std::string("metering/") + bench.name, 401, {.extra_ns = bench.extra_ns}, [=] {
      const auto f = std::make_shared<Metered>(bench.budget);
      const auto timed = [f](auto call) {
        return [=] {
          return seconds_of(kMeteredCalls, [&] {
            f->theta *= 1 - 1e-9;  // a little better each time, or the run would have stalled
            call(*f);
          });
        };
      };
      return Pair{timed(bench.call),
                  timed([](Metered& m) { m.problem.forward(m.theta, m.point); })};
    });
}

// --- Ceres and NLopt through us over their plain use, on the same problem without a meter, for the
// same iterations. `recorded` is the time that a record shows; `whole` includes what the harness
// does off the clock.

// The problem as a careful user of a library would call it.
struct Plain {
  const Problem& problem;
  mutable Point at = {};
  mutable Matrix J = {}, g = {};

  double loss(const double* x, double* gradient) const {
    const Index n = problem.unknowns();
    problem.forward(Map<const Vector>(x, n), at);
    if (!gradient) return at.loss;
    g.resize(problem.outputs(), problem.samples());
    problem.cotangent(at, g);
    problem.pullback(g, Map<Vector>(gradient, n), at);
    return at.loss;
  }
};

struct PlainResiduals final : ceres::CostFunction {
  Plain plain;

  explicit PlainResiduals(const Problem& problem) : plain{problem} {
    set_num_residuals(static_cast<int>(problem.residuals()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.unknowns()));
  }
  bool Evaluate(double const* const* x, double* r, double** out) const override {
    using RowMajor = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    plain.loss(x[0], nullptr);
    plain.problem.residual(plain.at, Map<Vector>(r, num_residuals()));
    if (!out || !out[0]) return true;
    plain.problem.jacobian(plain.J, plain.at);
    Map<RowMajor>(out[0], plain.J.rows(), plain.J.cols()) = plain.J;
    return true;
  }
};

struct PlainLoss final : ceres::FirstOrderFunction {
  Plain plain;

  explicit PlainLoss(const Problem& problem) : plain{problem} {}
  int NumParameters() const override { return static_cast<int>(plain.problem.unknowns()); }
  bool Evaluate(const double* x, double* loss, double* gradient) const override {
    *loss = plain.loss(x, gradient);
    return true;
  }
};

template <class Options>
Options plain_options(int iterations) {
  FLAGS_minloglevel = google::GLOG_FATAL;
  Options options;
  options.max_num_iterations = iterations;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0;
  options.logging_type = ceres::SILENT;
  return options;
}

void plain_ceres_lm(const Problem& problem, int iterations) {
  Vector x = problem.start();
  auto options = plain_options<ceres::Solver::Options>(iterations);
  options.linear_solver_type = ceres::DENSE_QR;
  ceres::Problem blocks;
  blocks.AddResidualBlock(new PlainResiduals(problem), nullptr, x.data());
  ceres::Solver::Summary summary;
  ceres::Solve(options, &blocks, &summary);
}

void plain_ceres_lbfgs(const Problem& problem, int iterations) {
  Vector x = problem.start();
  auto options = plain_options<ceres::GradientProblemSolver::Options>(iterations);
  options.line_search_direction_type = ceres::LBFGS;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, ceres::GradientProblem(new PlainLoss(problem)), x.data(), &summary);
}

// For as many evaluations: NLopt counts no iterations.
void plain_nlopt_lbfgs(const Problem& problem, int evaluations) {
  Plain plain{problem};
  Vector x = problem.start();
  const nlopt_opt search = nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(x.size()));
  const auto evaluate = [](unsigned, const double* at, double* gradient, void* self) {
    return static_cast<Plain*>(self)->loss(at, gradient);
  };
  nlopt_set_min_objective(search, evaluate, &plain);
  nlopt_set_maxeval(search, evaluations);
  nlopt_set_vector_storage(search, 100);  // as ours by default
  double loss = 0;
  nlopt_optimize(search, x.data(), &loss);
  nlopt_destroy(search);
}

struct Library {
  const char* name;
  int iterations, calls, pairs;  // calls: solves timed at once
  void (*plain)(const Problem& problem, int iterations);
  bool counts_evaluations = false;  // of the plain solve
};

const Library kLibraries[] = {
    {"ceres-lm[linear-solver=dense-qr]", 2, 1, 3, plain_ceres_lm},
    {"ceres-lbfgs", 20, 10, 101, plain_ceres_lbfgs},
    {"nlopt-lbfgs", 20, 10, 101, plain_nlopt_lbfgs, true},
};

// A solve that starts afresh: its seconds by our clock, and what its record holds.
std::pair<double, TracePoint> solve_of_ours(const Problem& problem, const Library& library) {
  const auto trial = std::make_unique<Trial>(problem, library.name, endless(library.iterations));
  const double seconds = seconds_of(1, [&] {
    Checkpoint nothing;
    drive(*trial->method, trial->meter, problem.start(), nothing);
  });
  return {seconds, trial->trace.last};
}

Pair library_pair(const Library& library, bool is_recorded) {
  const auto problem = std::make_shared<const Problem>(make_problem("broyden-tridiagonal[n=1000]"));
  const auto forward = static_cast<std::size_t>(Oracle::forward);
  const int count = library.counts_evaluations
                        ? static_cast<int>(solve_of_ours(*problem, library).second.counts[forward])
                        : library.iterations;
  return {[=] {
            double seconds = 0;
            for (int call = 0; call < library.calls; ++call) {
              const auto [whole, last] = solve_of_ours(*problem, library);
              seconds += is_recorded ? last.wall_seconds : whole;
            }
            return seconds / library.calls;
          },
          [=] { return seconds_of(library.calls, [&] { library.plain(*problem, count); }); }};
}

void register_libraries() {
  for (const Library& library : kLibraries) {
    const std::string name = std::string("library/") + library.name;
    register_pair(name + "/recorded", library.pairs, {.ratio = 1.1},
                  [=] { return library_pair(library, true); });
    register_pair(name + "/whole", library.pairs, {}, [=] { return library_pair(library, false); });
  }
}

// A step of ours in bundle adjustment over Ceres' by a dense Schur complement, on one problem. The
// first of them includes the analysis of the pattern.
void register_bundle() {
  const char* const spec = std::getenv("ISOLINE_BAL") ? "bal[file=problem-49-7776-pre.txt]"
                                                      : "bal[cameras=49,points=7776]";
  register_pair(fmt::format("bundle/levenberg-marquardt/{}", spec), 5, {.ratio = 1.1}, [=] {
    const auto problem = std::make_shared<const Problem>(make_problem(spec));
    const auto step_seconds = [problem](const char* method) {
      constexpr int kSteps = 10;
      const Library steps{method, kSteps, 1, 1, nullptr};
      return solve_of_ours(*problem, steps).second.wall_seconds / kSteps;
    };
    return Pair{[=] { return step_seconds("levenberg-marquardt"); },
                [=] { return step_seconds("ceres-lm[linear-solver=dense-schur]"); }};
  });
}

// --- a forward pass and a pullback of the grid problems over the fastest transforms of FFTW that
// are known for them: those of Poisson's are real ones of the odd extensions of all lines.

// There and back again, twice.
struct BareTransforms {
  Vector grid;                // (N²)
  Eigen::VectorXcd spectrum;  // of the grid, or of one line's extension
  fftw_plan there = nullptr, back = nullptr;
  int lines = 1;

  BareTransforms(int N, bool is_by_lines)
      : grid(Vector::Ones(Index{N} * N)), spectrum(Eigen::VectorXcd::Zero((Index{N} / 2 + 2) * N)) {
    constexpr unsigned kThere = FFTW_ESTIMATE | FFTW_PRESERVE_INPUT;
    auto* const complex = reinterpret_cast<fftw_complex*>(spectrum.data());
    if (is_by_lines) {
      there = fftw_plan_dft_r2c_1d(2 * (N + 1), grid.data(), complex, kThere);
      back = fftw_plan_dft_r2c_1d(2 * (N + 1), grid.data(), complex, kThere);
      lines = N;
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

  double run() {
    grid.setOnes();  // unnormalized, they would overflow
    return seconds_of(1, [this] {
      for (int pass = 0; pass < 2 * lines; ++pass) {
        fftw_execute(there);
        fftw_execute(back);
      }
    });
  }
};

void register_transforms() {
  struct Bench {
    const char* problem;
    bool is_by_lines;
    double ratio;  // promised
  };
  for (const int N : {64, 512})
    for (const Bench& bench : {Bench{"poisson", true, 1.6}, Bench{"heat", false, 1.3}}) {
      const std::string spec = fmt::format("{}[N={}]", bench.problem, N);
      register_pair("transforms/" + spec, N < 100 ? 1001 : 61, {.ratio = bench.ratio}, [=] {
        const auto problem = std::make_shared<const Problem>(make_problem(spec));
        const auto bare = std::make_shared<BareTransforms>(N, bench.is_by_lines);
        const auto ours = [problem, at = std::make_shared<Point>(),
                           g = std::make_shared<Matrix>(problem->outputs(), problem->samples()),
                           gradient = std::make_shared<Vector>(problem->unknowns())] {
          return seconds_of(1, [&] {
            problem->forward(problem->start(), *at);
            problem->cotangent(*at, *g);
            problem->pullback(*g, *gradient, *at);
          });
        };
        return Pair{ours, [=] { return bare->run(); }};
      });
    }
}

// --- a round trip of the process adapter: a forward of a program that returns its x, over the bare
// frames of one that sends them back

constexpr int kTrips = 50;

std::string command_of(const char* script, Index n) {
  static const std::string python = [] {  // with NumPy, where an interpreter has it
    for (const std::string each : {"python3", "/usr/bin/python3"})
      if (std::system((each + " -c 'import numpy' >/dev/null 2>&1").c_str()) == 0) return each;
    return std::string("python3");
  }();
  return fmt::format("{} {}/benchmarks/micro/{} {}", python, ISOLINE_SOURCE_DIR, script, n);
}

struct Frames {
  explicit Frames(Index n)
      : line(door_to(command_of("echo_frames.py", n))), numbers(static_cast<std::size_t>(n)) {}
  double run() {
    return seconds_of(kTrips, [&] {
      line.send(Verb::linearize, 0, std::span<const Real>(numbers));
      line.receive_answer(Verb::linearize, numbers);
    });
  }

  Line line;
  std::vector<Real> numbers;
};

void register_round_trips() {
  // Promised are 15 and 40 µs of a round trip, where bare frames were measured to take 6 and 17.
  for (const auto& [n, ratio] : {std::pair<Index, double>{2, 15.0 / 6}, {4096, 40.0 / 17}})
    register_pair(fmt::format("adapter/forward/n={}", n), 201, {.ratio = ratio}, [n = n] {
      const auto problem = std::make_shared<const Problem>(
          make_problem("process[command=" + quoted(command_of("echo.py", n)) + "]"));
      const auto bare = std::make_shared<Frames>(n);
      const auto ours = [problem, at = std::make_shared<Point>()] {
        return seconds_of(kTrips, [&] { problem->forward(problem->start(), *at); });
      };
      return Pair{ours, [=] { return bare->run(); }};
    });
}

// --- one step of half-inverse gradients over LAPACK's thin SVD of the same Jacobian alone, at the
// start and where a hundred steps have led. The step includes the forward pass and everything that
// J or its Gram matrix takes. At the published cut-offs the spectra of these problems reach below
// 1e-5 of the largest, so that the default is by a split Gram matrix, and for the chain by QR,
// which agree with the SVD to 1e-9; factorization=layers differs from it by up to 1e-5 there, as an
// SVD in single precision does.

struct Spectral {
  const char* problem;
  const char* method;
  double ratio;  // promised
};
const Spectral kSpectral[] = {
    {"linear-chain[mode=learn,batch=32]", "hig[rate=2,cutoff=1e-10]", 1.0 / 2},
    {"coupled-oscillators[mode=learn,batch=128]", "hig[rate=2]", 1.0 / 5},
    {"coupled-oscillators[mode=learn,batch=128]", "hig[rate=2,factorization=layers]", 1.0 / 5},
    {"quantum-dipole[mode=learn,batch=16]", "hig[rate=0.5,cutoff=1e-5]", 1.0 / 10},
    {"quantum-dipole[mode=learn,batch=16]", "hig[rate=0.5,cutoff=1e-5,factorization=layers]",
     1.0 / 10},
};

// A method that is asked for the same step again and again, some steps from the start.
struct Still {
  Still(const Problem& problem, const std::string& spec, int steps)
      : trial(problem, spec, endless()), theta(problem.start()) {
    trial.meter.begin(theta);
    trial.method->start(trial.meter, theta);
    for (int i = 0; i < steps; ++i) {
      trial.method->step(trial.meter, theta);
      trial.meter.iterate(theta);
    }
  }
  double run() {
    moved = theta;
    return seconds_of(1, [this] { trial.method->step(trial.meter, moved); });
  }

  Trial trial;
  Vector theta, moved;  // (n)
};

// As numpy.linalg.svd and the published scripts have it.
double thin_svd_seconds(const Matrix& J) {
  const auto m = static_cast<lapack_int>(J.rows()), n = static_cast<lapack_int>(J.cols());
  const lapack_int r = std::min(m, n);
  Matrix scratch = J, U(m, r), Vt(r, n);
  Vector sigma(r);
  return seconds_of(1, [&] {
    LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', m, n, scratch.data(), m, sigma.data(), U.data(), m,
                   Vt.data(), r);
  });
}

void register_spectral() {
  for (const Spectral& bench : kSpectral)
    for (const int steps : {0, 100})
      register_pair(fmt::format("spectral/{}/{}/{}", bench.method, bench.problem,
                                steps > 0 ? "after 100 steps" : "start"),
                    5, {.ratio = bench.ratio}, [=] {
                      const auto problem =
                          std::make_shared<const Problem>(make_problem(bench.problem));
                      const auto still = std::make_shared<Still>(*problem, bench.method, steps);
                      Point at;
                      problem->forward(still->theta, at);
                      const auto J = std::make_shared<Matrix>();
                      problem->jacobian(*J, at);
                      return Pair{[problem, still] { return still->run(); },
                                  [=] { return thin_svd_seconds(*J); }};
                    });
}

// --- the parts of a step of half-inverse gradients, which the published scripts time apart: the
// derivative (a forward pass and J), the inversion (all from J to Δθ), and the update of θ.

void time_parts(benchmark::State& state, const char* text) {
  const Problem problem = make_problem(text);
  Still still(problem, "hig[factorization=svd]", 0);
  std::vector<double> derivative, inversion, update;  // s
  for (auto _ : state) {
    Point at;
    Matrix J;
    derivative.push_back(seconds_of(1, [&] {
      problem.forward(still.theta, at);
      problem.jacobian(J, at);
    }));
    const double step = still.run();
    const Vector delta = still.moved - still.theta;
    update.push_back(seconds_of(1, [&] { still.moved = still.theta + delta; }));
    inversion.push_back(step - derivative.back() - update.back());
    state.SetIterationTime(step);
  }
  state.counters["derivative_ns"] = 1e9 * median(derivative);
  state.counters["inversion_ns"] = 1e9 * median(inversion);
  state.counters["update_ns"] = 1e9 * median(update);
}

void register_parts() {
  for (const char* problem :
       {"linear-chain[mode=learn,batch=32]", "coupled-oscillators[mode=learn,batch=128]",
        "quantum-dipole[mode=learn,batch=16]"})
    benchmark::RegisterBenchmark(fmt::format("parts/hig/{}", problem).c_str(), time_parts, problem)
        ->Iterations(5)
        ->UseManualTime();
}

// --- a step of SPRING on a physics-informed network over the products of matrices that it is made
// of: value, gradient and Laplacian of all points through the layers, their change along the last
// step, the cotangents, the rows of J, K = JJᵀ and its Cholesky decomposition, and the pullback.

// All arrays of the layers of z = W a + b, with so many lanes in all.
class BareSpring {
 public:
  BareSpring(const Problem& problem, Index lanes) : K_(problem.samples(), problem.samples()) {
    for (const Block& block : problem.layout())
      if (block.kind == Block::Kind::weight) layers_.emplace_back(block, lanes, problem.samples());
  }
  double run() {
    return seconds_of(1, [this] {
      for (Layer& at : layers_) {
        multiply(CblasNoTrans, CblasNoTrans, at.W, at.A, 0, at.Z);
        multiply(CblasNoTrans, CblasNoTrans, at.W, at.A, 0, at.dZ);
        multiply(CblasNoTrans, CblasNoTrans, at.W, at.A, 1, at.dZ);
        multiply(CblasTrans, CblasNoTrans, at.W, at.G, 0, at.H);
        multiply(CblasNoTrans, CblasTrans, at.G, at.A, 0, at.JTu);
      }
      K_.setIdentity();
      for (Layer& at : layers_) add_gram(at);
      const auto B = static_cast<int>(K_.rows());
      LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', B, K_.data(), B);
    });
  }

 private:
  struct Layer {
    Layer(const Block& block, Index lanes, Index samples)
        : W(Matrix::Constant(block.rows, block.columns, 1e-2)),
          A(Matrix::Constant(block.columns, lanes, 1e-2)),
          G(Matrix::Constant(block.rows, lanes, 1e-2)),
          Z(block.rows, lanes),
          dZ(block.rows, lanes),
          H(block.columns, lanes),
          JTu(block.rows, block.columns),
          rows(block.rows * block.columns, samples) {}
    Matrix W, A, G, Z, dZ, H, JTu, rows;
  };
  static void multiply(CBLAS_TRANSPOSE a, CBLAS_TRANSPOSE b, const Matrix& A, const Matrix& B,
                       double keep, Matrix& C) {
    const auto k = static_cast<int>(a == CblasNoTrans ? A.cols() : A.rows());
    const auto rows = static_cast<int>(C.rows()), columns = static_cast<int>(C.cols());
    cblas_dgemm(CblasColMajor, a, b, rows, columns, k, 1, A.data(), static_cast<int>(A.rows()),
                B.data(), static_cast<int>(B.rows()), keep, C.data(), rows);
  }
  // A row of J is the sum of the outer products of its lanes.
  void add_gram(Layer& at) {
    const Index samples = K_.rows(), each = at.A.cols() / samples;
    const auto o = static_cast<int>(at.W.rows()), i = static_cast<int>(at.W.cols());
    for (Index b = 0; b < samples; ++b)
      cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, o, i, static_cast<int>(each), 1,
                  &at.G(0, b * each), o, &at.A(0, b * each), i, 0, &at.rows(0, b), o);
    cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, static_cast<int>(samples), o * i, 1,
                at.rows.data(), o * i, 1, K_.data(), static_cast<int>(samples));
  }

  Matrix K_;
  std::vector<Layer> layers_;
};

void register_spring() {
  constexpr const char* kSpec = "pinn-poisson[dimension=10]";
  constexpr Index kInside = 100, kLanes = 12;  // of a point inside; one on the boundary has 1
  register_pair(fmt::format("spring/{}", kSpec), 21, {.ratio = 1.3}, [=] {
    const auto problem = std::make_shared<const Problem>(make_problem(kSpec));
    const auto still = std::make_shared<Still>(*problem, "spring[factorization=cholesky]", 0);
    const auto bare =
        std::make_shared<BareSpring>(*problem, kInside * kLanes + problem->samples() - kInside);
    return Pair{[problem, still] { return still->run(); }, [=] { return bare->run(); }};
  });
}

}  // namespace
}  // namespace isoline::benchmarks::micro

int main(int count, char** arguments) {
  using namespace isoline::benchmarks::micro;
  isoline::prepare_libraries(arguments);
  register_metering();
  register_libraries();
  register_bundle();
  register_transforms();
  register_round_trips();
  register_spectral();
  register_parts();
  register_spring();
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
