// Tomography with few angles: y = A x, line integrals of an image x of N² squares over (−1, 1)²,
// along parallel rays.
//
//   y(φ, s) = ∫ x(s cos φ − t sin φ, s sin φ + t cos φ) dt
// Radon (1917); in the form of Hansen, Jørgensen (2018), AIR Tools II, paralleltomo: A holds the
// lengths of rays inside squares. Data can be of a finer image, a sum of bells: model="N=32".
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "problems/dense_physics.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

struct Radon {
  Index N = 16, angles = 8, rays = 23;
};
void fields(Radon& o, auto& field) {
  field("N", o.N, between(2, 64), "squares along each side");
  field("angles", o.angles, between(1, 180), "directions φ, evenly over a half turn");
  field("rays", o.rays, between(1, 256), "parallel rays of each direction, evenly over (−1, 1)");
}

class RaySums final : public DensePhysics {
 public:
  explicit RaySums(const Radon& o) : DensePhysics(o.N * o.N, o.angles * o.rays) {
    A_.setZero(outputs(), inputs());
    for (Index a = 0; a < o.angles; ++a)
      for (Index r = 0; r < o.rays; ++r) {
        const Real angle = std::numbers::pi * Real(a) / Real(o.angles);
        const Real s = -1 + (2 * static_cast<Real>(r) + 1) / static_cast<Real>(o.rays);
        add_ray(std::cos(angle), std::sin(angle), s, o.N, a * o.rays + r);
      }
  }
  void value(VectorRef x, VectorOut y) const override { y.noalias() = A_ * x; }
  void derivative(VectorRef, BatchOut J) const override { J = A_; }

 private:
  // The ray between two crossings of grid lines lies in the square of their midpoint.
  void add_ray(Real c, Real d, Real s, Index N, Index row) {
    const Real h = 2 / static_cast<Real>(N), reach = std::numbers::sqrt2;
    std::vector<Real> crossings{-reach, reach};
    for (Index i = 0; i <= N; ++i) {
      const Real line = -1 + h * static_cast<Real>(i);
      for (const Real t : {(s * c - line) / d, (line - s * d) / c})
        if (std::abs(t) < reach) crossings.push_back(t);  // not where the ray is parallel
    }
    std::ranges::sort(crossings);
    for (std::size_t k = 1; k < crossings.size(); ++k) {
      const Real t = (crossings[k - 1] + crossings[k]) / 2;
      const auto i = static_cast<Index>(std::floor((s * c - t * d + 1) / h));
      const auto j = static_cast<Index>(std::floor((s * d + t * c + 1) / h));
      if (i < 0 || j < 0 || i >= N || j >= N) continue;
      A_(row, i + N * j) += crossings[k] - crossings[k - 1];
    }
  }
  Matrix A_;  // (angles·rays, N²)
};

// Bells with centres in the disc of radius 0.6.
Vector truth_of(Index N, RandomStream stream) {
  Vector truth = Vector::Zero(N * N);
  for (int bell = 0; bell < 4; ++bell) {
    const Real radius = 0.6 * std::sqrt(stream.uniform());
    const Real angle = 2 * std::numbers::pi * stream.uniform();
    const Real width = stream.uniform(0.15, 0.35), height = stream.uniform(-1, 1);
    for (Index k = 0; k < truth.size(); ++k) {
      const Real u = Real(2 * (k % N) + 1) / Real(N) - 1, v = Real(2 * (k / N) + 1) / Real(N) - 1;
      const Real apart = std::hypot(u - radius * std::cos(angle), v - radius * std::sin(angle));
      truth[k] += height * std::exp(-apart * apart / (2 * width * width));
    }
  }
  return truth;
}

ProblemParts make_radon(const Radon& o, const Draw& draw) {
  return from_exact_data(std::make_unique<RaySums>(o), truth_of(o.N, draw.stream("target")), draw,
                         StartScale::own);
}

}  // namespace

void register_radon(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "radon",
       .title = "Tomography with few angles",
       .group = Group::physics,
       .formula = "P(x) = A x,  Aᵣₖ the length of ray r in square k,  L = ½‖P(x) − y*‖²",
       .source = "Radon (1917); Hansen, Jørgensen (2018), AIR Tools II",
       .note = "With fewer rays than squares, no data determine a part of x*. Every start is 0.",
       .aim = Aim::x,
       .is_linear = true,
       .in_all = false},
      make_radon));
}

}  // namespace isoline::problems
