// Three methods that invert a physics: by its own inverse, by Newton's method, by L-BFGS.
#include "optimizers/inversion.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/decompose.h"

namespace isoline::optimizers {
namespace {

// x̃ = x − η ∂L/∂x, L a sample's own loss: theorem 2 of Holl, Koltun, Thuerey (2022). Of several
// such steps the sum, as long as the first of each sample: GD_accumulate of their script for the
// fluid.
class AlongGradient final : public Inversion {
 public:
  explicit AlongGradient(Real step, Index steps = 1) : step_(step), steps_(steps) {}

  Index invert(Meter& f, Linearization& at, Matrix& found) override {
    found = at.x();
    descend(at, found);
    if (steps_ == 1) return 0;
    const auto length = [&] { return (found - at.x()).colwise().norm().eval(); };
    const RowVector first = length();
    for (Index i = 1; i < steps_ && !f.is_spent(); ++i) {
      f.linearize_physics(found, further_);
      descend(further_, found);
    }
    const RowVector whole = length();
    for (Index b = 0; b < found.cols(); ++b)
      if (whole[b] > 0)
        found.col(b) = at.x().col(b) + first[b] / whole[b] * (found.col(b) - at.x().col(b));
    return 0;
  }

 private:
  using RowVector = Eigen::Matrix<Real, 1, Eigen::Dynamic>;

  void descend(Linearization& at, Matrix& x) {
    const auto samples = static_cast<Real>(x.cols());
    at.cotangent(g_);
    slope_.resizeLike(x);
    at.physics_pullback(g_, slope_);
    x -= step_ * samples * slope_;
  }

  Real step_;
  Index steps_;
  Linearization further_;
  Matrix g_, slope_;  // (m, B), (k, B) of the mean loss
};

// Where y is to go for a share of the way: y + share Δy, Δy = y* − y or, sample by sample, Newton's
// step −|H|⁻¹ ∂L/∂y, H = ∂²L/∂y², of the book's chapter on scale invariance. The signs of H are
// left out, as saddle-free Newton does, or losses without a minimum in y, such as an infidelity,
// would rise. There is no step along directions without curvature.
class TargetStep {
 public:
  explicit TargetStep(bool is_newton) : is_newton_(is_newton) {}

  void set(Meter& f, const Linearization& at, Real share, Matrix& wanted) {
    if (is_newton_) {
      find_newton_step(at);
      wanted = at.y() + share * step_;
    } else if (share == 1) {
      wanted = f.target();
    } else {
      wanted = at.y() + share * (f.target() - at.y());
    }
  }

 private:
  void find_newton_step(const Linearization& at) {
    const Index m = at.y().rows(), samples = at.y().cols();
    at.cotangent(step_);
    unit_.setZero(m, samples);
    column_.resize(m, samples);
    H_.resize(m, m * samples);
    for (Index i = 0; i < m; ++i) {
      unit_.row(i).setOnes();
      at.loss_curvature(unit_, column_);
      unit_.row(i).setZero();
      for (Index b = 0; b < samples; ++b) H_.col(b * m + i) = column_.col(b);
    }
    for (Index b = 0; b < samples; ++b) {
      if (!symmetric_eigen(H_.middleCols(b * m, m), eigen_)) continue;
      const Real least = std::numeric_limits<Real>::epsilon() * eigen_.lambda.cwiseAbs().maxCoeff();
      along_ = eigen_.V.transpose() * step_.col(b);
      for (Index i = 0; i < m; ++i) {
        const Real size = std::abs(eigen_.lambda[i]);
        along_[i] = size > least * static_cast<Real>(m) ? -along_[i] / size : 0;
      }
      step_.col(b) = eigen_.V * along_;
    }
  }

  bool is_newton_;
  SymmetricEigen eigen_;
  Matrix step_, unit_, column_, H_;  // (m, B) ∂L/∂y and then Δy; (m, B) twice; (m, m·B)
  Vector along_;                     // (m)
};

// The problem's own: x̃ = P⁻¹(y + η (y* − y); x), or x + η (P⁻¹(y*; x) − x) where it does not undo
// P.
class ByProblem final : public Inversion {
 public:
  explicit ByProblem(const InversionOptions& o)
      : step_(o.step),
        falls_back_(o.fallback == "gradient"),
        aim_(o.difference == "newton"),
        gradient_(o.step) {}

  // A sample whose inverse fails keeps its x, and gives no gradient; or moves along its gradient.
  Index invert(Meter& f, Linearization& at, Matrix& found) override {
    const bool undoes_physics = f.inverse_kind() == Inverse::exact;
    aim_.set(f, at, undoes_physics ? step_ : 1, wanted_);
    found = at.x();
    const Success success = at.local_inverse(wanted_, found);
    if (!undoes_physics) found = at.x() + step_ * (found - at.x());
    if (success.all()) return 0;
    instead_ = at.x();
    if (falls_back_) gradient_.invert(f, at, instead_);
    for (Index b = 0; b < success.size(); ++b)
      if (!success[b]) found.col(b) = instead_.col(b);
    return falls_back_ ? success.size() - success.count() : 0;
  }

 private:
  Real step_;
  bool falls_back_;
  TargetStep aim_;
  AlongGradient gradient_;
  Matrix wanted_, instead_;  // (m, B), (k, B)
};

// H = V diag(S) Vᵀ of symmetric H, for the sizes that a Jacobi rotation makes diagonal at once: its
// tangent is t = 2H₀₁/(d ± √(d² + 4H₀₁²)), d = H₁₁ − H₀₀; Golub, Van Loan (2013), symmetric Schur.
struct Pair {
  Eigen::Matrix2d V;
  Eigen::Vector2d S;

  bool decompose(const Eigen::Matrix2d& H) {
    const Real twice = 2 * H(0, 1), d = H(1, 1) - H(0, 0);
    const Real root = std::sqrt(d * d + twice * twice);
    const Real t = twice == 0 ? 0 : twice / (d < 0 ? d - root : d + root);
    const Real cosine = 1 / std::sqrt(1 + t * t), sine = t * cosine;
    S << H(0, 0) - t * H(0, 1), H(1, 1) + t * H(0, 1);
    V << cosine, sine, -sine, cosine;
    return true;
  }
};
struct Single {
  Eigen::Matrix<Real, 1, 1> V{1}, S{0};

  bool decompose(const Eigen::Matrix<Real, 1, 1>& H) {
    S = H;
    return true;
  }
};
struct General {
  SymmetricEigen eigen;
  Matrix& V = eigen.V;
  Vector& S = eigen.lambda;

  bool decompose(const Matrix& H) { return symmetric_eigen(H, eigen); }
};

// The steps along an eigenvector of curvature S where the slope is g̃, with the sign of g̃.
struct SaddleFree {
  Real max_loss_change;
  Real operator()(Real slope, Real curvature, Real mean) const {
    return saddle_free_length(slope, curvature, mean, max_loss_change);
  }
};
struct Plain {
  Real clip, damping;
  Real operator()(Real slope, Real curvature, Real) const {
    const Real bend = curvature + damping;
    if (bend == 0) return 0;
    const Real length = std::abs(slope / bend);
    return std::copysign(clip > 0 ? std::min(length, clip) : length, slope);
  }
};

// x̃ = x + η U, U the step on ½‖P(x) − y*‖² of that length along each eigenvector of its Hessian.
template <class Length>
class ByNewton final : public Inversion {
 public:
  ByNewton(Real step, Length length) : step_(step), length_(length) {}

  Index invert(Meter& f, Linearization& at, Matrix& found) override {
    const Index k = at.x().rows();
    misfit_ = at.y() - f.target();
    bend_.resize(k, at.x().size());
    at.curvature(misfit_, bend_);
    const Matrix& dy_dx = at.sensitivity();
    found = at.x();
    if (k == 1)
      step_all<1, Single>(dy_dx, found);
    else if (k == 2)
      step_all<2, Pair>(dy_dx, found);
    else
      step_all<Eigen::Dynamic, General>(dy_dx, found);
    return 0;
  }

 private:
  template <int K, class Eigenbasis>
  void step_all(const Matrix& dy_dx, Matrix& found) const {
    const Index k = found.rows();
    Eigen::Matrix<Real, K, K> H(k, k);
    Eigen::Matrix<Real, K, 1> row(k), slope(k), along(k);
    Eigenbasis basis;
    for (Index b = 0; b < found.cols(); ++b) {
      H = bend_.middleCols<K>(b * k, k);
      slope.setZero();
      for (Index i = 0; i < misfit_.rows(); ++i) {
        row = dy_dx.block<1, K>(i, b * k, 1, k).transpose();
        H.noalias() += row.lazyProduct(row.transpose());
        slope += misfit_(i, b) * row;
      }
      if (!basis.decompose(H)) continue;
      along.noalias() = basis.V.transpose() * slope;
      const Real mean = geometric_mean(basis.S);
      for (Index i = 0; i < k; ++i) along[i] = length_(along[i], basis.S[i], mean);
      if (is_finite(along)) found.col(b).noalias() -= step_ * (basis.V * along);
    }
  }

  Real step_;
  Length length_;
  Matrix misfit_;  // (m, B) P(x) − y*
  Matrix bend_;    // (k, k·B) Σᵢ (P(x) − y*)ᵢ ∇²Pᵢ
};

// x̃ = argmin ½‖P(x) − y − η Δy‖² from the current x, by L-BFGS over all samples at once.
class ByLbfgs final : public Inversion {
 public:
  explicit ByLbfgs(const InversionOptions& o)
      : step_(o.step), most_evaluations_(o.inverse_evaluations), aim_(o.difference == "newton") {}

  // To the rounding of what is wanted.
  Index invert(Meter& f, Linearization& at, Matrix& found) override {
    constexpr Real kRelativeMisfit = 1e-14;
    aim_.set(f, at, step_, wanted_);
    const Index k = at.x().rows(), samples = at.x().cols();
    flat_ = at.x().reshaped();
    const auto misfit = [&](VectorRef x, VectorOut gradient) {
      f.linearize_physics(Eigen::Map<const Matrix>(x.data(), k, samples), trial_);
      misfit_ = trial_.y() - wanted_;
      trial_.physics_pullback(misfit_, Eigen::Map<Matrix>(gradient.data(), k, samples));
      return 0.5 * misfit_.squaredNorm();
    };
    minimize_lbfgs(misfit,
                   {.evaluations = most_evaluations_,
                    .enough = 0.5 * kRelativeMisfit * kRelativeMisfit * wanted_.squaredNorm(),
                    .is_over = [&] { return f.is_spent(); }},
                   flat_);
    found = flat_.reshaped(k, samples);
    return 0;
  }

 private:
  Real step_;
  Index most_evaluations_;
  TargetStep aim_;
  Linearization trial_;
  Matrix wanted_, misfit_;  // (m, B)
  Vector flat_;             // (k·B)
};

bool uses_own_inverse(const InversionOptions& o, Inverse kind) {
  if (o.inverse == "auto") return kind != Inverse::none;
  return o.inverse == "analytic" || o.inverse == "damped";
}

}  // namespace

std::unique_ptr<Inversion> make_inversion(const InversionOptions& o, Inverse kind) {
  if (uses_own_inverse(o, kind)) return std::make_unique<ByProblem>(o);
  if (o.inverse == "gradient") return std::make_unique<AlongGradient>(o.step);
  constexpr Index kAccumulated = 8;  // of the published script
  if (o.inverse == "gradients") return std::make_unique<AlongGradient>(o.step, kAccumulated);
  if (o.inverse == "newton")
    return std::make_unique<ByNewton<SaddleFree>>(o.step, SaddleFree{o.max_loss_change});
  return std::make_unique<ByLbfgs>(o);
}

OracleSet needs_of(const InversionOptions& o, const Problem& problem) {
  OracleSet needs{Oracle::forward, Oracle::network};
  if (uses_own_inverse(o, problem.inverse_kind())) {
    needs.add(Oracle::inverse);
    if (o.fallback == "gradient") needs.add(Oracle::pullback);
  } else if (o.inverse == "newton") {
    needs.add(Oracle::sensitivity);
    needs.add(Oracle::curvature);
  } else {
    needs.add(Oracle::pullback);
  }
  return needs;
}

std::string objection_to(const InversionOptions& o, const Problem& problem) {
  if (o.inverse == "damped" && problem.inverse_kind() != Inverse::damped)
    return "inverse=damped, and the physics has an inverse, but not a damped one";
  constexpr Index kMostOutputs = 512;  // numbers of y, of which H is factorized
  if (o.difference == "newton" && problem.outputs() > kMostOutputs)
    return fmt::format("difference=newton is for up to {} numbers of y per sample, not {}",
                       kMostOutputs, problem.outputs());
  return o.inverse == "newton" ? objection_to_newton(problem, "inverse=newton") : "";
}

std::unique_ptr<Inversion> inversion_by_plain_newton(Real clip, Real damping) {
  return std::make_unique<ByNewton<Plain>>(1, Plain{clip, damping});
}

std::string objection_to_newton(const Problem& problem, std::string_view what) {
  constexpr Index kMostInputs = 8;
  if (problem.inputs() <= kMostInputs) return "";
  return fmt::format("{} is for up to {} inputs of the physics, which has {}", what, kMostInputs,
                     problem.inputs());
}

}  // namespace isoline::optimizers
