// A step of the flow on 64×64 cells over what it cannot do without: the two transforms of its
// projection and one pass through the memory of each field. And the adjoint over the forward step.
#include "benchmarks/micro/pairs.h"
#include "core/fourier.h"
#include "core/random.h"
#include "problems/physics/flow_physics.h"
#include "problems/physics/simulation.h"

namespace isoline::benchmarks::micro {

using problems::draw_flow;
using problems::FlowOptions;
using problems::FlowRun;
using problems::FlowSample;
using problems::Simulation;
namespace {

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

void register_fluid() {
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
