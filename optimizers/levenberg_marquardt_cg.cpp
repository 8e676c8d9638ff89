// Levenberg-Marquardt by products, for problems too large for a Jacobian: θ ← θ + d,
// d ≈ argmin ‖J d + r‖² + μ‖d‖² by conjugate gradients on JᵀJ + μ in the form of Paige and Saunders
// (1982), section 7.1, which forms neither. They end where the gradient of that is down to η of its
// start, η = min(0.1, √(‖g‖/‖g₀‖)), g = Jᵀr at this and the first point: inexact at first, ever
// more exact near a solution; Dembo, Eisenstat, Steihaug (1982). The damping starts at 10⁻⁴ of ‖J
// g‖²/‖g‖² and follows the gain of each step by the rule of Nielsen (1999), as that of
// levenberg-marquardt does. Unlike there, μ is in units of the unknowns: there are no columns to
// scale by. With blocks, all of this is done for e = Bᵀd in the place of d, where B Bᵀ is the block
// diagonal of JᵀJ: the block Jacobi preconditioner of Agarwal, Snavely, Seitz, Szeliski (2010),
// which scales the damping, too.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/archive.h"
#include "core/array.h"
#include "core/sparse.h"
#include "optimizers/nielsen_damping.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

// B of the block diagonal B Bᵀ of JᵀJ, by the parameter blocks of a sparse J.
class BlockScaling {
  template <class List>
  static auto& in(List& list, int i) {
    return list[static_cast<std::size_t>(i)];
  }

 public:
  // False where a block is not positive definite, as where no residual depends on an unknown.
  bool set(const SparsePattern& pattern, const Vector& values) {
    pattern_ = &pattern;
    blocks_.assign(static_cast<std::size_t>(pattern.parameter_blocks()), {});
    for (int j = 0; j < pattern.parameter_blocks(); ++j)
      in(blocks_, j).setZero(pattern.size_of(j), pattern.size_of(j));
    for (int i = 0; i < pattern.residual_blocks(); ++i)
      pattern.for_each_block(i, [&](int block, int offset) {
        for (int row = in(pattern.residual_block, i); row < in(pattern.residual_block, i + 1);
             ++row) {
          const Eigen::Map<const Vector> part(values.data() + in(pattern.row_start, row) + offset,
                                              pattern.size_of(block));
          in(blocks_, block).noalias() += part * part.transpose();
        }
      });
    return std::ranges::all_of(blocks_, [](Matrix& block) {
      block.diagonal() *= 1 + kRaised;
      return Eigen::LLT<Eigen::Ref<Matrix>>(block).info() == Eigen::Success;
    });
  }
  void solve(Vector& v, bool is_transposed) const {  // v ← B⁻¹ v or B⁻ᵀ v
    for (int j = 0; j < pattern_->parameter_blocks(); ++j) {
      auto part = v.segment(in(pattern_->parameter_block, j), pattern_->size_of(j));
      const auto B = in(blocks_, j).triangularView<Eigen::Lower>();
      is_transposed ? B.transpose().solveInPlace(part) : B.solveInPlace(part);
    }
  }

 private:
  static constexpr Real kRaised = 1e-12;  // for points that are seen along one ray
  const SparsePattern* pattern_ = nullptr;
  std::vector<Matrix> blocks_;  // lower halves: B
};

struct LevenbergMarquardtCg {
  Index cg_iterations = 100;
  Real initial_damping = 1e-4;
  std::string preconditioner;

  struct State {
    BlockScaling blocks;
    NielsenDamping damping;
    Real first_slope = 0;  // ‖g₀‖
    Linearization at;
    Matrix residual;             // (m, B) −r
    Vector gradient;             // (n) −g = −Jᵀr
    Matrix left, moved;          // (m, B) −r − J d, J p
    Vector step, slope, p;       // (n) d, −g − (JᵀJ + μ) d, direction
    Vector unscaled, candidate;  // (n) B⁻ᵀ of a vector
  };
  static void persist(State& s, Archive& archive) {
    s.damping.persist(archive);
    archive(s.first_slope);
  }
  State init(Meter&, const Vector&) const { return {}; }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.residual = f.target() - s.at.y();
    s.gradient.resize(theta.size());
    s.at.pullback(s.residual, s.gradient);
    if (s.gradient.isZero(0)) return Status::converged;
    if (has_blocks()) {
      if (!s.blocks.set(*f.sparse_pattern(), s.at.sparse_jacobian())) return Status::stalled;
      s.blocks.solve(s.gradient, false);
    }
    if (s.damping.mu == 0) set_damping(s);
    if (!conjugate_gradients(f, s)) return Status::stalled;
    s.candidate = theta + unscaled(s, s.step);
    if (s.candidate == theta && !f.has_fresh_batches()) return Status::converged;
    const Real gain = (s.at.loss() - f.loss(s.candidate)) / predicted_decrease(s);
    if (!(gain > 0)) {
      f.reject_step();
      return s.damping.reject();
    }
    theta = s.candidate;
    s.damping.accept(gain);
    return Status::running;
  }

  bool has_blocks() const { return !preconditioner.empty(); }
  const Vector& unscaled(State& s, const Vector& e) const {
    s.unscaled = e;
    if (has_blocks()) s.blocks.solve(s.unscaled, true);
    return s.unscaled;
  }

  void set_damping(State& s) const {
    s.first_slope = s.gradient.norm();
    s.moved.resizeLike(s.residual);
    s.at.pushforward(unscaled(s, s.gradient), s.moved);
    s.damping.mu = initial_damping * s.moved.squaredNorm() / s.gradient.squaredNorm();
  }

  bool conjugate_gradients(Meter& f, State& s) const {
    s.left = s.residual;
    s.moved.resizeLike(s.left);
    s.step.setZero(s.gradient.size());
    s.p = s.slope = s.gradient;
    Real slope = s.slope.squaredNorm();
    const Real forcing = std::min(0.1, std::sqrt(std::sqrt(slope) / s.first_slope));
    const Real enough = forcing * forcing * slope;
    for (Index i = 0; i < cg_iterations && slope > enough && !f.is_spent(); ++i) {
      s.at.pushforward(unscaled(s, s.p), s.moved);
      const Real alpha = slope / (s.moved.squaredNorm() + s.damping.mu * s.p.squaredNorm());
      if (!(alpha > 0 && std::isfinite(alpha))) return i > 0;
      s.step += alpha * s.p;
      s.left -= alpha * s.moved;
      s.at.pullback(s.left, s.slope);
      if (has_blocks()) s.blocks.solve(s.slope, false);
      s.slope -= s.damping.mu * s.step;
      const Real before = std::exchange(slope, s.slope.squaredNorm());
      s.p = s.slope + slope / before * s.p;
    }
    return is_finite(s.step);
  }

  // The predicted decrease of the loss, which is a multiple of ½‖r‖²; for ½‖r‖² and any d it is
  // ½ dᵀ(−g) + ½ dᵀ(−g − (JᵀJ + μ) d) + ½μ‖d‖².
  static Real predicted_decrease(const State& s) {
    const Real of_squares =
        0.5 * (s.step.dot(s.gradient) + s.step.dot(s.slope) + s.damping.mu * s.step.squaredNorm());
    return of_squares * s.at.loss() / (0.5 * s.residual.squaredNorm());
  }
};

void fields(LevenbergMarquardtCg& o, auto& field) {
  field("cg-iterations", o.cg_iterations, between(1, 1e6),
        "most conjugate-gradient iterations per step");
  field("initial-damping", o.initial_damping, above(0),
        "damping μ at the start, as a share of ‖J ∇L‖²/‖∇L‖²");
  field("preconditioner", o.preconditioner, {"", "blocks"},
        "blocks: products and damping are in units of the block diagonal of JᵀJ, from a sparse J");
}

OracleSet needs_of_cg(const OptionValues& options, const Problem&) {
  OracleSet needs{Oracle::forward, Oracle::pullback, Oracle::pushforward};
  if (!options.text("preconditioner").empty()) needs.add(Oracle::sparse_jacobian);
  return needs;
}

}  // namespace

void register_levenberg_marquardt_cg(OptimizerRegistry& registry) {
  registry.add(stepper_entry<LevenbergMarquardtCg>(
      {.name = "levenberg-marquardt-cg",
       .title = "Levenberg-Marquardt by products",
       .family = Family::curvature,
       .kind = Kind::least_squares,
       .formula = "θ ← θ + d,  d ≈ argmin ‖J d + r‖² + μ‖d‖² by conjugate gradients",
       .source = "Marquardt (1963); Paige, Saunders (1982), section 7.1; Nielsen (1999)",
       .note = "Never forms J: a step costs a pushforward and a pullback per iteration of the "
               "conjugate gradients. A rejected candidate is an iteration, too.",
       .needs = {Oracle::forward, Oracle::pullback, Oracle::pushforward},
       .tunable = {.option = "initial-damping", .factor = 10},
       .needs_for = needs_of_cg}));
}

}  // namespace isoline::optimizers
