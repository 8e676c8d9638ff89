// Self-scaled Broyden: a dense quasi-Newton method with a line search, θ ← θ − α H ∇L, whose H is
// scaled down at each update as far as the curvature just seen requires, and lies between the
// updates of BFGS and DFP as Al-Baali, Khalfan (2005), "Wide interval for efficient self-scaling
// quasi-Newton algorithms", choose it; found by Urbán, Stefanou, Pons (2025), J. Comput. Phys. 523
// to train physics-informed networks to far smaller losses than BFGS. Full batch. The
// line search is to the strong Wolfe conditions. H starts as 1, scaled at the first update as BFGS
// is, Nocedal, Wright (2006), eq. 6.20.
#include "optimizers/ssbroyden.h"

#include <algorithm>
#include <cmath>

#include "core/real.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {

void update_self_scaled(Matrix& H, const Vector& s, const Vector& y, Real bend, Vector& Hy,
                        Vector& v) {
  const Real ys = y.dot(s);
  Hy.noalias() = H * y;
  const Real yHy = y.dot(Hy);
  const Real b = bend / ys, h = yHy / ys, a = std::max(h * b - 1, Real(0));  // by Cauchy, Schwarz
  Real theta = 1, phi = 1, tau = 1;
  if (a > 0) {
    const Real rho_minus = std::min(Real(1), h * (1 - std::sqrt(a / (a + 1))));
    const Real rho_plus = std::min(Real(1), 1 / b);
    theta = std::max((rho_minus - 1) / a, std::min(1 / rho_minus, (1 - b) / b));
    phi = (1 - theta) / (1 + a * theta);
    const Real sigma = 1 + a * theta;
    const auto n = static_cast<Real>(H.rows());
    const Real mean = H.rows() > 1 ? std::pow(sigma, -1 / (n - 1)) : 1;
    tau = theta > 0 ? rho_plus * std::min(mean, 1 / theta) : std::min(rho_plus * mean, sigma);
  }
  v = s / ys - Hy / yHy;
  const Real weight = phi * yHy;
  for (Index j = 0; j < H.cols(); ++j)  // rounding must not make it asymmetric bit by bit
    H.col(j) = (H.col(j) - Hy[j] / yHy * Hy + weight * v[j] * v) / tau + s[j] / ys * s;
  H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
}

namespace {

struct SelfScaledBroyden {
  Real sufficient_decrease = 1e-4, curvature = 0.9;

  struct State {
    Matrix H;                // (n, n)
    Vector gradient, along;  // (n), at θ, and −H ∇L
    Real loss = 0;
    bool has_point = false, is_scaled = false;
    Linearization at;
    Vector trial_gradient, candidate, y, Hy, v;  // (n)
  };
  static void persist(State& s, Archive& archive) {
    archive(s.H, s.gradient, s.loss, s.has_point, s.is_scaled);
  }
  State init(Meter&, const Vector& theta) const {
    State s;
    s.H = Matrix::Identity(theta.size(), theta.size());
    return s;
  }

  Status step(Meter& f, Vector& theta, State& s) const {
    if (!s.has_point) {
      f.linearize(theta, s.at);
      s.at.gradient(s.gradient);
      s.loss = s.at.loss();
      s.has_point = true;
    }
    if (s.gradient.isZero(0)) return Status::converged;
    const auto lengthen = [&] {
      s.along.noalias() = -(s.H * s.gradient);
      return s.gradient.dot(s.along);
    };
    Real slope = lengthen();
    if (!(slope < 0)) {  // lost to rounding
      s.H.setIdentity();
      s.is_scaled = false;
      slope = lengthen();
    }
    const Trial found = search(f, theta, s, slope);
    if (found.length == 0 && f.is_spent()) return Status::running;  // which the harness ends
    if (found.length == 0) {
      f.claim("the line search found no lower loss");
      return Status::stalled;
    }
    move(theta, s, found, slope);
    return Status::running;
  }

  struct Trial {
    Real length = 0, value = 0, slope = 0;  // α, φ(α), φ'(α)
  };

  // To the strong Wolfe conditions, from length 1, but at first along the gradient, which has no
  // other unit, from a step of length 1. If no trial meets both conditions, the best that lowers φ
  // enough, or length 0 without one.
  Trial search(Meter& f, const Vector& theta, State& s, Real along_slope) const {
    constexpr int kMostTrials = 25;
    const auto evaluate = [&](Real length) -> Trial {
      s.candidate = theta + length * s.along;
      f.linearize(s.candidate, s.at);
      s.at.gradient(s.trial_gradient);
      return {length, s.at.loss(), s.trial_gradient.dot(s.along)};
    };
    const Trial start{.length = 0, .value = s.loss, .slope = along_slope};
    Trial found = start;
    Real length = s.is_scaled ? 1 : std::min(Real(1), 1 / s.along.norm());
    Trial low = start, high = start;
    bool is_bracketed = false;
    for (int i = 0; i < kMostTrials && length > 0 && !f.is_spent(); ++i) {
      const Trial at = evaluate(length);
      const bool is_low_enough =
          at.value <= start.value + sufficient_decrease * length * start.slope;
      if (is_low_enough && std::abs(at.slope) <= curvature * std::abs(start.slope)) return at;
      if (is_low_enough && at.value < found.value) found = at;
      if (!is_low_enough || at.value >= low.value) {  // nan as well
        high = at;
        is_bracketed = true;
      } else {
        const Real away = is_bracketed ? high.length - low.length : 1;
        if (at.slope * away >= 0) {
          high = low;
          is_bracketed = true;
        }
        low = at;
      }
      constexpr Real kGrowth = 4;
      length = is_bracketed ? between(low, high) : kGrowth * length;
    }
    // The gradient is that of the last trial, which a search that failed may have gone past.
    return found.length > 0 ? evaluate(found.length) : found;
  }

  // Ibid., eq. 3.59, at least a tenth of the bracket from either end; its middle where an end is
  // not finite.
  static Real between(const Trial& low, const Trial& high) {
    constexpr Real kMargin = 0.1;
    const Real gap = high.length - low.length;
    const Real d1 = low.slope + high.slope - 3 * (high.value - low.value) / gap;
    const Real root = std::copysign(std::sqrt(d1 * d1 - low.slope * high.slope), gap);
    const Real share = 1 - (high.slope + root - d1) / (high.slope - low.slope + 2 * root);
    if (!std::isfinite(share)) return low.length + 0.5 * gap;
    return low.length + std::clamp(share, kMargin, 1 - kMargin) * gap;
  }

  void move(Vector& theta, State& s, const Trial& found, Real slope) const {
    theta = s.candidate;
    s.y = s.trial_gradient - s.gradient;
    s.along *= found.length;  // s
    const Real ys = s.y.dot(s.along);
    const Real bend = -found.length * found.length * slope;  // sᵀ H⁻¹ s, s = −α H ∇L
    if (ys > 0 && std::isfinite(ys)) {
      Real scale = 1;
      if (!s.is_scaled) {
        scale = ys / s.y.squaredNorm();
        s.H *= scale;
        s.is_scaled = true;
      }
      update_self_scaled(s.H, s.along, s.y, bend / scale, s.Hy, s.v);
    }
    s.gradient = s.trial_gradient;
    s.loss = found.value;
  }
};

void fields(SelfScaledBroyden& o, auto& field) {
  field("sufficient-decrease", o.sufficient_decrease, between(0, 1), "c₁ of the line search");
  field("curvature", o.curvature, between(0, 1), "c₂ of the line search");
}

}  // namespace

void register_ssbroyden(OptimizerRegistry& registry) {
  registry.add(stepper_entry<SelfScaledBroyden>(
      {.name = "ssbroyden",
       .title = "Self-scaled Broyden",
       .family = Family::curvature,
       .kind = Kind::quasi_newton,
       .formula = "θ ← θ − α H ∇L,  H ← (H − Hy yᵀH/(yᵀHy) + φ v vᵀ)/τ + s sᵀ/(yᵀs)",
       .source = "Al-Baali, Khalfan (2005); Urbán, Stefanou, Pons (2025)",
       .note =
           "The update is as printed by the authors. Dense, with a line search to the strong "
           "Wolfe conditions. H is scaled before its first update as in BFGS, which the authors "
           "leave optional.",
       .needs = {Oracle::forward, Oracle::pullback},
       .needs_same_samples = true,
       .most_unknowns = 3000,
       .tunable = {.option = "curvature", .below = 6, .factor = 1.5}}));
}

}  // namespace isoline::optimizers
