// The state of the Kuramoto-Sivashinsky equation on a ring of length L, backwards in time:
//
//   u̇ = −u ∂u − ∂²u − ∂⁴u,   u(0) = Σₙ aₙ cos κₙs + bₙ sin κₙs,  κₙ = 2πn/L,   P(a, b) = u(T)
//
// Kuramoto (1978), Sivashinsky (1977). Waves with κ < 1 grow and feed the others, and from L ≈ 22
// on the flow is chaotic, so the conditioning of J worsens with T. The steps are those of ETDRK4,
// Cox and Matthews (2002), with the coefficients of Kassam and Trefethen (2005). All linear maps
// are circulant, and are applied as dense matrices; the products with J are those of the steps
// themselves.
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <numbers>

#include "problems/learning.h"

namespace isoline::problems {
namespace {

constexpr Real kTau = 2 * std::numbers::pi;

struct KuramotoSivashinsky {
  Real length = 22, time = 10;
  Index waves = 0, points = 0, steps = 0;
};
void fields(KuramotoSivashinsky& o, auto& field) {
  field("length", o.length, between(1, 400), "length L of the ring");
  field("time", o.time, between(1e-3, 1000), "time T");
  field("waves", o.waves, between(0, 512),
        "number of waves of x, which has two unknowns for each; 0: those with κ ≤ 1.2");
  field("points", o.points, between(0, 1026),
        "even number of points; 0: as many as resolve κ ≤ 4.5");
  field("steps", o.steps, between(0, 1e5), "time steps; 0: T/0.1");
}

// With the defaults that depend on L and T.
KuramotoSivashinsky completed(KuramotoSivashinsky o) {
  require(
      o.points == 0 || (o.points % 2 == 0 && kTau * static_cast<Real>(o.points) >= 4 * o.length),
      "kuramoto-sivashinsky: points must be even, and resolve κ ≤ 2: at least 2 L/π");
  const Index most = o.points == 0 ? 512 : o.points / 2 - 1;
  const auto waves_up_to = [&](Real kappa) {
    return std::clamp<Index>(static_cast<Index>(kappa * o.length / kTau), 1, most);
  };
  if (o.waves == 0) o.waves = waves_up_to(1.2);
  if (o.points == 0) o.points = 2 * std::max(waves_up_to(4.5), o.waves) + 2;
  if (o.steps == 0) o.steps = static_cast<Index>(std::ceil(o.time / 0.1));
  require(2 * o.waves < o.points, "kuramoto-sivashinsky: points must be more than twice the waves");
  return o;
}

class KuramotoFlow final : public Physics {
 public:
  explicit KuramotoFlow(const KuramotoSivashinsky& o)
      : steps_(o.steps), waves_(o.points, 2 * o.waves) {
    for (Index n = 1; n <= o.waves; ++n)
      for (Index i = 0; i < o.points; ++i) {
        const Real angle = kTau * static_cast<Real>(n * i) / static_cast<Real>(o.points);
        waves_(i, 2 * n - 2) = std::cos(angle);
        waves_(i, 2 * n - 1) = std::sin(angle);
      }
    const Real dt = o.time / static_cast<Real>(o.steps);
    using Complex = std::complex<Real>;
    using Symbol = std::function<Complex(Complex z)>;
    // The circulant matrix of a function of z = Δt (κ² − κ⁴), times −½ ∂ if it acts on u².
    const auto circulant = [&](bool acts_on_square, const Symbol& symbol) {
      Vector column = Vector::Zero(o.points);
      for (Index n = 0; n <= o.points / 2; ++n) {
        const Real kappa = kTau * static_cast<Real>(n) / o.length;
        const Real z = dt * (kappa * kappa - std::pow(kappa, 4)), value = mean_near(symbol, z);
        const bool is_double = n > 0 && 2 * n < o.points;  // n and −n
        for (Index i = 0; i < o.points; ++i) {
          const Real angle = kTau * static_cast<Real>(n * i) / static_cast<Real>(o.points);
          const Real wave =
              acts_on_square ? (is_double ? 0.5 * kappa * std::sin(angle) : 0) : std::cos(angle);
          column[i] += (is_double ? 2 : 1) * value * wave / static_cast<Real>(o.points);
        }
      }
      Matrix out(o.points, o.points);
      for (Index j = 0; j < o.points; ++j)
        for (Index i = 0; i < o.points; ++i) out(i, j) = column[(i - j + o.points) % o.points];
      return out;
    };
    full_ = circulant(false, [](Complex z) { return std::exp(z); });
    half_ = circulant(false, [](Complex z) { return std::exp(z / 2.0); });
    drive_ = circulant(true, [&](Complex z) { return dt * (std::exp(z / 2.0) - 1.0) / z; });
    first_ = circulant(true, [&](Complex z) {
      return dt * (-4.0 - z + std::exp(z) * (4.0 - 3.0 * z + z * z)) / (z * z * z);
    });
    second_ = circulant(true, [&](Complex z) {
      return 2 * dt * (2.0 + z + std::exp(z) * (z - 2.0)) / (z * z * z);
    });
    third_ = circulant(true, [&](Complex z) {
      return dt * (-4.0 - 3.0 * z - z * z + std::exp(z) * (4.0 - z)) / (z * z * z);
    });
  }
  Index inputs() const override { return waves_.cols(); }
  Index outputs() const override { return waves_.rows(); }
  Vector waves_of(VectorRef u) const {  // x of a state: its columns are orthogonal
    return 2.0 / static_cast<Real>(u.size()) * (waves_.transpose() * u);
  }

  // w.saved[0]: v, a, b, c of each step side by side, (N, 4·steps·B); the others: scratch.
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace& w) const override {
    const Index N = outputs(), B = x.cols();
    w.saved.resize(kSaved);
    Matrix &all = w.saved[0], &squares = w.saved[1];
    all.resize(N, 4 * steps_ * B);
    squares.resize(N, 4 * B);
    y.noalias() = waves_ * x;
    for (Index t = 0; t < steps_; ++t) {
      const auto stage = [&](Index i) { return all.middleCols((4 * t + i) * B, B); };
      const auto square = [&](Index i) { return squares.middleCols(i * B, B); };
      auto v = stage(0), a = stage(1), b = stage(2), c = stage(3);
      v = y;
      square(0) = v.cwiseAbs2();
      a.noalias() = half_ * v;
      b = a;
      a.noalias() += drive_ * square(0);
      square(1) = a.cwiseAbs2();
      b.noalias() += drive_ * square(1);
      square(2) = b.cwiseAbs2();
      square(3) = 2 * square(2) - square(0);
      c.noalias() = half_ * a;
      c.noalias() += drive_ * square(3);
      square(1) += square(2);
      square(3) = c.cwiseAbs2();
      y.noalias() = full_ * v;
      y.noalias() += first_ * square(0);
      y.noalias() += second_ * square(1);
      y.noalias() += third_ * square(3);
    }
  }

  void pushforward(BatchRef d, BatchOut Jd, Workspace& w) const override {
    const Index B = d.cols();
    const Matrix& all = w.saved[0];
    Matrix &dv = w.saved[2], &da = w.saved[3], &db = w.saved[4], &dc = w.saved[5];
    Matrix* const squares = &w.saved[6];  // three
    dv.noalias() = waves_ * d;
    for (Index t = 0; t < steps_; ++t) {
      const auto twice = [&](Index i, const auto& tangent) {  // of the square of a stage
        return 2 * all.middleCols((4 * t + i) * B, B).cwiseProduct(tangent);
      };
      squares[0] = twice(0, dv);
      da.noalias() = half_ * dv;
      db = da;
      da.noalias() += drive_ * squares[0];
      squares[1] = twice(1, da);
      db.noalias() += drive_ * squares[1];
      squares[2] = twice(2, db);
      squares[1] += squares[2];
      squares[2] = 2 * squares[2] - squares[0];
      dc.noalias() = half_ * da;
      dc.noalias() += drive_ * squares[2];
      squares[2] = twice(3, dc);
      da.noalias() = full_ * dv;
      da.noalias() += first_ * squares[0];
      da.noalias() += second_ * squares[1];
      da.noalias() += third_ * squares[2];
      dv.swap(da);
    }
    Jd = dv;
  }

  // Backward through the steps: g is the cotangent of the next v, and then of v.
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    const Index B = u.cols();
    const Matrix& all = w.saved[0];
    Matrix &g = w.saved[2], &gc = w.saved[3], &gb = w.saved[4], &ga = w.saved[5], &gv = w.saved[6],
           &shared = w.saved[7], &driven = w.saved[8];
    g = u;
    for (Index t = steps_; t-- > 0;) {
      const auto twice = [&](Index i, const auto& cotangent) {
        return 2 * all.middleCols((4 * t + i) * B, B).cwiseProduct(cotangent);
      };
      driven.noalias() = third_.transpose() * g;
      gc = twice(3, driven);
      driven.noalias() = drive_.transpose() * gc;  // of 2 b² − v²
      shared.noalias() = second_.transpose() * g;  // of a² + b²
      gb = twice(2, shared + 2 * driven);
      gv.noalias() = first_.transpose() * g;
      gv -= driven;  // of v²
      driven.noalias() = drive_.transpose() * gb;
      ga = twice(1, shared + driven);
      ga.noalias() += half_.transpose() * gc;
      gv.noalias() += drive_.transpose() * ga;
      gv = twice(0, gv);
      gb += ga;
      gv.noalias() += half_.transpose() * gb;
      gv.noalias() += full_.transpose() * g;
      g.swap(gv);
    }
    JTu.noalias() = waves_.transpose() * g;
  }

 private:
  // The mean over a circle around z, which avoids the cancellation near 0; Kassam and Trefethen
  // (2005), section 3. Of the upper half: the lower is its conjugate.
  template <class Symbol>
  static Real mean_near(const Symbol& symbol, Real z) {
    constexpr int kPoints = 32;
    Real sum = 0;
    for (int j = 0; j < kPoints; ++j)
      sum += symbol(z + std::polar<Real>(1, std::numbers::pi * (j + 0.5) / kPoints)).real();
    return sum / kPoints;
  }

  static constexpr std::size_t kSaved = 9;
  Index steps_;
  Matrix waves_;                                         // (N, k): u(0) by x
  Matrix full_, half_, drive_, first_, second_, third_;  // (N, N)
};

// x* is on the attractor: the waves of x in the state that a random one reaches in a time of 100.
ProblemParts make_kuramoto_sivashinsky(const KuramotoSivashinsky& options, const Draw& draw) {
  const KuramotoSivashinsky o = completed(options);
  KuramotoSivashinsky transient = o;
  transient.time = 100;
  transient.steps = 1000;
  const KuramotoFlow flow(transient);
  RandomStream stream = draw.stream("target");
  Workspace w;
  Matrix state(o.points, 1);
  flow.forward(stream.normal_vector(2 * o.waves), Matrix(0, 1), state, w);
  return from_exact_data(std::make_unique<KuramotoFlow>(o), flow.waves_of(state), draw);
}

}  // namespace

void register_kuramoto_sivashinsky(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "kuramoto-sivashinsky",
       .title = "The Kuramoto-Sivashinsky equation backwards",
       .group = Group::physics,
       .formula = "u̇ = −u ∂u − ∂²u − ∂⁴u,  x = the waves of u(0),  P(x) = u(T),  "
                  "L = ½‖P(x) − y*‖²",
       .source = "Kuramoto (1978); Sivashinsky (1977); Kassam, Trefethen (2005)",
       .note = "x* is a state of the attractor, from our own random streams for seed 0, too, "
               "reduced to its longest waves. The flow is chaotic: the longer T is, the worse J is "
               "conditioned, and the more local minima the loss has.",
       .aim = Aim::x,
       .in_all = false},
      make_kuramoto_sivashinsky));
}

}  // namespace isoline::problems
