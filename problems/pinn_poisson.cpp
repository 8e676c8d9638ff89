// A network that solves Poisson's equation: physics-informed learning as least squares in θ,
//
//   −Δu = f in Ω = (0, 1)^d,  u = u* on ∂Ω,  u = N(p; θ),
//   L = ½ (1/N_Ω Σ (Δu + f)² + β/N_∂ Σ (u − u*)²),
//
// N a perceptron of hyperbolic tangents in double precision. A sample is a collocation point p: the
// network maps it to x = (u, Δu), and the physics picks one of the two, y = √(B/N_Ω) Δu inside and
// √(βB/N_∂) u on the boundary, B = N_Ω + N_∂. The error in x is ‖u − u*‖/‖u*‖ over the points of
// the validation in Ω. By dimension:
//    2  sin πp₁ sin πp₂, a grid, β = 4: Müller, Zeinhofer (2023), arXiv 2302.13163, section 4.1;
//       their loss has no ½
//    5  Σ cos πpᵢ, 10  p₁p₂ + p₃p₄ + …, new points in each step, β = 1: Guzmán-Cordero, Dangel,
//       Goldshlager, Zeinhofer (2025), arXiv 2505.12149
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "networks/laplacian_perceptron.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

// y = ⟨c, x⟩ for the weights c (2, B) of the samples.
class WeightedResidual final : public Physics {
 public:
  Index inputs() const override { return 2; }
  Index outputs() const override { return 1; }
  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace&) const override {
    y = x.cwiseProduct(c).colwise().sum();
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Jv = v.cwiseProduct(w.context).colwise().sum();
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    JTu = (w.context.array().rowwise() * u.row(0).array()).matrix();
  }
};

// An equation by its solution u* and its right side f = −Δu*, with the published settings.
struct Equation {
  Index dimension;
  const char* layers;
  Index interior, boundary;
  const char* points;
  Real boundary_weight;  // β
  Real deviation;        // of the start
  Real (*solution)(VectorRef p);
  Real (*source)(VectorRef p);
};

constexpr Real kPi = std::numbers::pi;
const Equation kEquations[] = {
    {2, "32", 784, 120, "grid", 4, 0.1,
     [](VectorRef p) { return std::sin(kPi * p[0]) * std::sin(kPi * p[1]); },
     [](VectorRef p) { return 2 * kPi * kPi * std::sin(kPi * p[0]) * std::sin(kPi * p[1]); }},
    {5, "64-64-48-48", 3000, 500, "fresh", 1, 0,
     [](VectorRef p) -> Real { return (kPi * p.array()).cos().sum(); },
     [](VectorRef p) -> Real { return kPi * kPi * (kPi * p.array()).cos().sum(); }},
    {10, "256-256-128-128", 100, 50, "fresh", 1, 0,
     [](VectorRef p) {
       Real sum = 0;
       for (Index i = 0; i < p.size(); i += 2) sum += p[i] * p[i + 1];
       return sum;
     },
     [](VectorRef) -> Real { return 0; }}};

struct PinnPoisson {
  std::string mode = kLearnMode, layers, points;
  Index dimension = 2, interior = 0, boundary = 0;
};
void fields(PinnPoisson& o, auto& field) {
  field(kModeOption, o.mode, {kDirectMode, kLearnMode}, "learn: the unknown is a network");
  field("dimension", o.dimension, between(2, 10),
        "d: 2, 5 or 10, each with its published settings");
  field("layers", o.layers, Choices{},
        "widths of the hidden layers; by default the published ones");
  field("points", o.points, Choices{"", "grid", "fixed", "fresh"},
        "collocation points: a regular grid, for d = 2; random ones; new ones in each step; by "
        "default as published");
  field("interior", o.interior, between(0, 1e5), "N_Ω, points in Ω; 0: as published");
  field("boundary", o.boundary, between(0, 1e5), "N_∂, points on ∂Ω; 0: as published");
}

// The points of a batch: those in Ω first.
class Collocation {
 public:
  Collocation(const Equation& of, Index interior, Index boundary, bool is_grid)
      : of_(of), interior_(interior), boundary_(boundary), is_grid_(is_grid) {
    side_ = static_cast<Index>(std::lround(std::sqrt(static_cast<Real>(interior))));
    require(!is_grid || (of.dimension == 2 && side_ * side_ == interior && boundary % 4 == 0 &&
                         boundary > 4 && points() != kValidation),
            "points=grid requires dimension=2, a square of a whole number as interior, and as "
            "boundary a multiple of 4 above 4");
  }
  static constexpr Index kValidation = 1024;
  Index points() const { return interior_ + boundary_; }

  // A batch of another size is that of the validation: random points in the same proportion.
  void draw(RandomStream& stream, Index b, Batch& batch) const {
    const Index count = batch.samples(), d = of_.dimension;
    const Index inside = count * interior_ / points();
    const bool is_inside = b < inside;
    auto p = batch.input.col(b).head(d);
    if (is_grid_ && count == points())
      is_inside ? place_inside(b, p) : place_on_side(b - inside, p);
    else
      is_inside ? place(stream, p) : place_on_face(stream, p);
    const Real u = of_.solution(p), laplacian = is_inside ? -of_.source(p) : 0;
    const auto B = static_cast<Real>(count),
               N = static_cast<Real>(is_inside ? inside : count - inside);
    batch.input(d, b) = is_inside ? 1 : 0;
    batch.truth.col(b) << u, laplacian;
    batch.context.col(b).setZero();
    batch.context(is_inside ? 1 : 0, b) = std::sqrt((is_inside ? 1 : of_.boundary_weight) * B / N);
    batch.target(0, b) = batch.context.col(b).dot(batch.truth.col(b));
  }

 private:
  static void place(RandomStream& stream, VectorOut p) {
    for (Index i = 0; i < p.size(); ++i) p[i] = stream.uniform();
  }
  static void place_on_face(RandomStream& stream, VectorOut p) {
    place(stream, p);
    const auto face = static_cast<Index>(stream.uniform() * 2 * static_cast<Real>(p.size()));
    p[face / 2] = static_cast<Real>(face % 2);
  }
  void place_inside(Index b, VectorOut p) const {
    const auto cells = static_cast<Real>(side_ + 1);
    p << static_cast<Real>(b % side_ + 1) / cells, static_cast<Real>(b / side_ + 1) / cells;
  }
  void place_on_side(Index b, VectorOut p) const {
    const Index along = boundary_ / 4, face = b / along;
    p[face / 2] = static_cast<Real>(face % 2);
    p[1 - face / 2] = static_cast<Real>(b % along) / static_cast<Real>(along - 1);
  }

  const Equation& of_;
  Index interior_, boundary_, side_;
  bool is_grid_;
};

// ‖u − u*‖/‖u*‖ over the samples in Ω
Real relative_error(BatchRef x, const Batch& batch) {
  Real gap = 0, whole = 0;
  for (Index b = 0; b < x.cols(); ++b) {
    if (batch.context(1, b) == 0) continue;
    gap += std::pow(x(0, b) - batch.truth(0, b), 2);
    whole += std::pow(batch.truth(0, b), 2);
  }
  return std::sqrt(gap / whole);
}

ProblemParts make_pinn_poisson(const PinnPoisson& o, const Draw& draw) {
  require(o.mode == kLearnMode, "pinn-poisson has only mode=learn; remove mode=direct");
  const auto found = std::ranges::find(kEquations, o.dimension, &Equation::dimension);
  require(found != std::end(kEquations), "pinn-poisson: dimension must be 2, 5 or 10");
  const Equation& of = *found;
  const Index interior = o.interior > 0 ? o.interior : of.interior;
  const Index boundary = o.boundary > 0 ? o.boundary : of.boundary;
  const std::string points = o.points.empty() ? of.points : o.points;
  const Collocation collocation(of, interior, boundary, points == "grid");
  const Index count = collocation.points();
  const Learning learning{.mode = o.mode, .batch = count, .data = points == "fresh" ? 0 : count};
  ProblemParts parts{
      .physics = std::make_unique<WeightedResidual>(),
      .network = networks::laplacian_perceptron(
          {.widths = networks::perceptron_widths("pinn-poisson", of.dimension,
                                                 o.layers.empty() ? of.layers : o.layers),
           .curved = of.dimension,
           .deviation = of.deviation}),
      .x_error = relative_error,
      .x_scale = 1,
      .samples = {.validation = Collocation::kValidation,
                  .contexts = 2,
                  .draw = [collocation](RandomStream& stream, Index b, Batch& batch) {
                    collocation.draw(stream, b, batch);
                  }}};
  return learn(learning, {.inputs = of.dimension + 1, .outputs = 2}, draw, std::move(parts));
}

}  // namespace

void register_pinn_poisson(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "pinn-poisson",
       .title = "Poisson's equation by a network",
       .group = Group::physics,
       .formula = "L = ½(1/N_Ω Σ(Δu + f)² + β/N_∂ Σ(u − u*)²),  u = N(p; θ)",
       .source = "Müller, Zeinhofer (2023); Guzmán-Cordero, Dangel, Goldshlager, Zeinhofer (2025)",
       .note = "A physics-informed network; a sample is a collocation point. dimension=2 has 129 "
               "unknowns and a grid of 904 points, 5 has 10,065 and 3,500 new points in each step, "
               "10 has 118,145 and 150. The error in x is the relative L2 error on fixed points.",
       .aim = Aim::x,
       .family = "laplacian",
       .in_all = false,
       .panels = {{.title = "Relative L2 error", .kind = "curve"}}},
      make_pinn_poisson));
}

}  // namespace isoline::problems
