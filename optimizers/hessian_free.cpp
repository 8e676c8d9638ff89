// Hessian-free optimization, Martens (2010): θ ← θ + α d, d ≈ −(JᵀL''J + λI)⁻¹ ∇L by conjugate
// gradients on products with the Gauss-Newton matrix, begun at 0.95 of the last solution and ended
// by Martens' test of relative progress. Of the iterates kept on the way d is the earliest after
// which the loss rose again; α by Armijo's rule from 1; λ by the reduction ratio ρ of Levenberg
// and Marquardt, ρ by the undamped model. Without preconditioner. curvature=hessian has ∇²L in
// place of JᵀL''J, as the published scripts of the SIP paper offer.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

constexpr Real kGrowth = 1.3;  // between the numbers of the iterates kept

struct HessianFree {
  Real damping = 1;
  Index cg_iterations = 250;
  std::string curvature;

  struct State {
    Real damping = 0;  // λ
    Vector solution;   // (n) of the last conjugate gradients
    Linearization at;
    Vector gradient, r, p, Ap, candidate;  // (n)
    Matrix Jv, curved;                     // (m, B) J v, L'' J v
    Matrix kept;                           // (n, most) iterates
    Vector kept_model;                     // φ of those
    Index count = 0;                       // of those
    Vector model;                          // φ after each iteration
  };
  static void persist(State& s, Archive& archive) { archive(s.damping, s.solution); }

  State init(Meter& f, const Vector& theta) const {
    const Index n = theta.size();
    const Real longest = std::log(static_cast<Real>(cg_iterations)) / std::log(kGrowth);
    State s;
    s.damping = damping;
    s.solution = s.r = s.p = s.Ap = s.candidate = Vector::Zero(n);
    s.Jv.resize(f.target().rows(), f.target().cols());
    s.curved = s.Jv;
    s.kept.resize(n, static_cast<Index>(longest) + 3);  // both ends, and the last of all
    s.kept_model.resize(s.kept.cols());
    s.model.resize(cg_iterations + 1);
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    s.at.gradient(s.gradient);
    if (s.gradient.isZero(0)) return f.has_fresh_batches() ? Status::running : Status::converged;
    conjugate_gradients(f, s);
    if (f.is_spent()) return Status::running;
    Real loss = 0;
    const Index best = backtrack(f, theta, s, loss);
    adapt(best, loss, s);
    const Eigen::Map<const Vector> d(s.kept.col(best).data(), s.kept.rows());
    constexpr Real kSufficient = 1e-2, kShorter = 0.8;
    constexpr int kTrials = 20;
    const Real slope = s.gradient.dot(d);
    Real alpha = 1;
    for (int trial = 0; !(loss <= s.at.loss() + kSufficient * alpha * slope); ++trial) {
      if (trial == kTrials || f.is_spent()) {
        f.reject_step();
        return Status::running;
      }
      alpha *= kShorter;
      s.candidate = theta + alpha * d;
      loss = f.loss(s.candidate);
    }
    theta += alpha * d;
    return Status::running;
  }

  void multiply(VectorRef v, State& s) const {  // Ap = (JᵀL''J + λI) v, or (∇²L + λI) v
    if (curvature == "hessian") {
      s.at.hessian_product(v, s.Ap);
    } else {
      s.at.pushforward(v, s.Jv);
      s.at.loss_curvature(s.Jv, s.curved);
      s.at.pullback(s.curved, s.Ap);
    }
    s.Ap += s.damping * v;
  }

  // Minimizes φ(d) = ½ dᵀA d + ∇Lᵀd, which is −½ dᵀ(r − ∇L) with the residual r = −∇L − A d.
  void conjugate_gradients(Meter& f, State& s) const {
    constexpr Real kWarmth = 0.95, kRounding = 1e-28;
    Vector& d = s.solution;
    d *= kWarmth;
    multiply(d, s);
    s.p = s.r = -s.gradient - s.Ap;
    s.count = 0;
    Index i = 0;
    s.model[0] = -0.5 * d.dot(s.r - s.gradient);
    Real rr = s.r.squaredNorm(), next = 1;
    const Real enough = kRounding * s.gradient.squaredNorm();
    while (i < cg_iterations && rr > enough && !has_converged(s.model, i) && !f.is_spent()) {
      multiply(s.p, s);
      const Real alpha = rr / s.p.dot(s.Ap);
      if (!(alpha > 0 && std::isfinite(alpha))) break;
      d += alpha * s.p;
      s.r -= alpha * s.Ap;
      s.model[++i] = -0.5 * d.dot(s.r - s.gradient);
      if (static_cast<Real>(i) >= next) keep(s.model[i], s);
      while (next <= static_cast<Real>(i)) next *= kGrowth;
      const Real before = std::exchange(rr, s.r.squaredNorm());
      s.p = s.r + rr / before * s.p;
    }
    keep(s.model[i], s);  // the last may be there twice
  }

  static void keep(Real model, State& s) {
    s.kept.col(s.count) = s.solution;
    s.kept_model[s.count++] = model;
  }

  // Martens (2010), section 4.4: less than kε of φ gained in the last k iterations.
  static bool has_converged(const Vector& model, Index i) {
    constexpr Real kEpsilon = 5e-4, kShare = 0.1;
    constexpr Index kLeast = 10;
    const Index k = std::max(kLeast, static_cast<Index>(kShare * static_cast<Real>(i)));
    return i > k && model[i] < 0 &&
           model[i] - model[i - k] > static_cast<Real>(k) * kEpsilon * model[i];
  }

  // Back from the last iterate for as long as the loss falls. Conjugate gradients that have nearly
  // converged differ by rounding, which moves the loss by up to 1e-9 of itself: that is no fall.
  static Index backtrack(Meter& f, const Vector& theta, State& s, Real& loss) {
    constexpr Real kLeastFall = 1e-6;
    const auto loss_of = [&](Index i) {
      s.candidate = theta + s.kept.col(i);
      return f.loss(s.candidate);
    };
    Index best = s.count - 1;
    loss = loss_of(best);
    while (best > 0 && !f.is_spent()) {
      const Real earlier = loss_of(best - 1);
      if (!(earlier < (1 - kLeastFall) * loss)) break;
      loss = earlier;
      --best;
    }
    return best;
  }

  // λ by ρ, the actual over the predicted decrease.
  static void adapt(Index best, Real loss, State& s) {
    constexpr Real kPoor = 0.25, kGood = 0.75, kRaise = 1.5;
    const Real model = s.kept_model[best] - 0.5 * s.damping * s.kept.col(best).squaredNorm();
    const Real ratio = (loss - s.at.loss()) / model;
    if (!(ratio >= kPoor)) s.damping *= kRaise;
    if (ratio > kGood) s.damping /= kRaise;
  }
};

void fields(HessianFree& o, auto& field) {
  field("damping", o.damping, above(0), "damping λ at the start");
  field("cg-iterations", o.cg_iterations, between(1, 1e6), "most conjugate-gradient iterations");
  field("curvature", o.curvature, Choices{"", "hessian"},
        "hessian: products with ∇²L instead of JᵀL''J; its conjugate gradients end at a direction "
        "of negative curvature");
}

}  // namespace

void register_hessian_free(OptimizerRegistry& registry) {
  OptimizerEntry entry = stepper_entry<HessianFree>(
      {.name = "hessian-free",
       .title = "Hessian-free optimization",
       .family = Family::curvature,
       .kind = Kind::second_order,
       .formula = "(JᵀL''J + λI) d ≈ −∇L by conjugate gradients,  θ ← θ + α d",
       .source = "Martens (2010)",
       .note = "A step costs two products per iteration of the conjugate gradients. All parts of a "
               "step use the same samples. A step without sufficient decrease is rejected. The "
               "Gauss-Newton matrix is that of network and physics together.",
       .needs = {Oracle::forward, Oracle::pullback, Oracle::pushforward},
       .tunable = {.option = "damping", .below = 4, .factor = 10}});
  entry.needs_for = [needs = entry.needs](const OptionValues& options, const Problem&) {
    return options.text("curvature") == "hessian"
               ? OracleSet{Oracle::forward, Oracle::pullback, Oracle::hessian_product}
               : needs;
  };
  registry.add(std::move(entry));
}

}  // namespace isoline::optimizers
