// Spectral steps: the factorizations by name, with their requirements and computations, including
// Krylov vectors and the split Gram matrix.
#include "optimizers/spectral_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/product.h"

namespace isoline::optimizers {
namespace {

struct FactorizationRow {
  Factorization factorization;
  std::string_view name, words;
};
constexpr FactorizationRow kFactorizations[] = {
    {Factorization::automatic, "auto", ""},
    {Factorization::svd, "svd", "the thin SVD of J"},
    {Factorization::qr, "qr", "QR and the SVD of R"},
    {Factorization::gram, "gram", "the Gram matrix of J"},
    {Factorization::layers, "layers", "the Gram matrix layer by layer"},
    {Factorization::split, "split", "the Gram matrix layer by layer, split in two"},
    {Factorization::cholesky, "cholesky", "Cholesky of the Gram matrix"},
    {Factorization::orthogonal, "orthogonal", "a complete orthogonal factorization"},
    {Factorization::lanczos, "lanczos", "Lanczos"},
};

// The choice of `automatic`. A Gram matrix squares the condition number. It is used if the
// estimated relative error of the step is at most 2e-9, and if the smallest σ that matters is at
// least 1e-5 of the largest (1e-7 if split in two). It is not tried if the cut-off is so near its
// rounding that this could not be detected.
constexpr Real kMostErrorByGram = 2e-9, kLeastShareByGram = 1e-5, kLeastShareBySplit = 1e-7;
constexpr Real kLeastCutoffByGram = 1e-7;

// Whether one number is enough of a spectrum: Tikhonov's filter with μ in units of the mean.
bool is_tikhonov(const SpectralFilter& filter) {
  return filter.kappa == 1 && filter.damping > 0 && filter.unit != SpectralFilter::Unit::largest;
}

// Whether every spectrum excludes a Gram matrix. A damping in units of the mean is judged when it
// is known.
bool never_by_gram(const SpectralFilter& filter) {
  const bool is_relative = filter.unit == SpectralFilter::Unit::largest;
  return filter.clamps ||
         (is_relative && std::max(filter.cutoff, std::sqrt(filter.damping)) < kLeastCutoffByGram);
}

}  // namespace

Real length_on_grid(Meter& f, const Vector& theta, const Vector& step, Real rate,
                    Vector& candidate) {
  constexpr int kHalvings = 30;
  Real best = 0, least = std::numeric_limits<Real>::infinity();
  for (int k = 0; k <= kHalvings; ++k) {
    const Real length = std::ldexp(rate, -k);
    candidate = theta + length * step;
    const Real loss = f.loss(candidate);
    if (loss < least) {
      least = loss;
      best = length;
    }
  }
  return best;
}

Factorization factorization_named(std::string_view name) {
  for (const FactorizationRow& row : kFactorizations)
    if (row.name == name) return row.factorization;
  throw UsageError(fmt::format("unknown factorization '{}' of a spectral step", name));
}

std::string_view factorization_text(Factorization factorization) {
  return kFactorizations[static_cast<std::size_t>(factorization)].words;
}

OracleSet needs_of(Factorization factorization, const SpectralFilter& filter,
                   const Problem& problem) {
  const OracleSet by_matrix{Oracle::forward, Oracle::jacobian};
  const OracleSet by_layers{Oracle::forward, Oracle::layer_factors, Oracle::pullback};
  const bool has_layers =
      problem.residuals() < problem.unknowns() && problem.offers().contains(Oracle::layer_factors);
  const bool has_jacobian = problem.offers().contains(Oracle::jacobian);
  switch (factorization) {
    case Factorization::lanczos:
      return {Oracle::forward, Oracle::pullback, Oracle::pushforward};
    case Factorization::layers:
    case Factorization::split:
      return by_layers;
    case Factorization::cholesky:
      return has_layers ? by_layers : by_matrix;
    case Factorization::automatic: {
      if (!has_layers) return by_matrix;
      if (has_jacobian && never_by_gram(filter)) return by_matrix;
      OracleSet both = by_layers;
      if (has_jacobian) both.add(Oracle::jacobian);
      return both;
    }
    default:
      return by_matrix;
  }
}

std::string objection_to(Factorization factorization, const Problem& problem) {
  const bool forms_K =
      factorization == Factorization::layers || factorization == Factorization::split;
  if (forms_K && problem.residuals() >= problem.unknowns())
    return fmt::format(
        "factorization={} forms JJᵀ and needs a wide J, got {} residuals and {} unknowns",
        kFactorizations[static_cast<std::size_t>(factorization)].name, problem.residuals(),
        problem.unknowns());
  return "";
}

// Golub-Kahan bidiagonalization with one side orthogonalized, and functions of what it finds.

namespace {

constexpr Real kMostBytes = 512.0 * 1024 * 1024;

// B, (size, size).
Matrix bidiagonal(const std::vector<Real>& alpha, const std::vector<Real>& beta, Index size) {
  Matrix B = Matrix::Zero(size, size);
  for (Index i = 0; i < size; ++i) {
    B(i, i) = alpha[static_cast<std::size_t>(i)];
    if (i + 1 < size) B(i, i + 1) = beta[static_cast<std::size_t>(i)];
  }
  return B;
}

}  // namespace

// J v, or Jᵀ v.
void LanczosStep::apply(Linearization& at, bool pushes, VectorRef v, Vector& out) {
  cotangent_.resize(at.y().rows(), at.y().cols());
  if (pushes) {
    at.pushforward(v, cotangent_);
    out = cotangent_.reshaped();
  } else {
    cotangent_ = v.reshaped(cotangent_.rows(), cotangent_.cols());
    out.resize(unknowns_);
    at.pullback(cotangent_, out);
  }
}

// s₁ is Jᵀw over the parameters, else w.
void LanczosStep::start(Linearization& at, const Vector& w, Index most) {
  alpha_.clear();
  beta_.clear();
  vectors_ = 0;
  is_exhausted_ = false;
  s_ = w;
  if (is_over_parameters_) apply(at, false, w, s_);
  length_ = s_.norm();
  S_.resize(s_.size(), most);
  if (length_ > 0) S_.col(0) = s_ / length_;
}

bool LanczosStep::extend(Linearization& at) {
  constexpr Real kExhausted = 1e-14;  // of the largest so far: rounding
  const Index k = vectors_;
  apply(at, is_over_parameters_, S_.col(k), t_);
  if (k > 0) t_ -= beta_.back() * last_t_;
  const Real alpha = t_.norm();
  const Real largest = alpha_.empty() ? alpha : *std::max_element(alpha_.begin(), alpha_.end());
  is_exhausted_ = !(alpha > kExhausted * largest);
  if (is_exhausted_) return false;
  t_ /= alpha;
  apply(at, !is_over_parameters_, t_, s_);
  s_ -= alpha * S_.col(k);
  for (int pass = 0; pass < 2; ++pass) {  // "twice is enough", Parlett (1998), §6.9
    overlap_.noalias() = S_.leftCols(k + 1).transpose() * s_;
    s_.noalias() -= S_.leftCols(k + 1) * overlap_;
  }
  const Real beta = s_.norm();
  alpha_.push_back(alpha);
  beta_.push_back(beta);
  vectors_ = k + 1;
  std::swap(t_, last_t_);
  is_exhausted_ = !(beta > kExhausted * largest);
  if (is_exhausted_ || vectors_ == S_.cols()) return false;
  S_.col(vectors_) = s_ / beta;
  return true;
}

// ‖s‖ h(BᵀB) e₁ of the first `size` vectors.
void LanczosStep::solve(const SpectralFilter& filter, Index size, Vector& out) {
  out.setZero(vectors_);
  if (size == 0 || !thin_svd(bidiagonal(alpha_, beta_, size), svd_)) return;
  const Spectrum spectrum{.largest = svd_.sigma[0]};
  overlap_ = length_ * svd_.Vt.col(0);
  for (Index i = 0; i < size; ++i) overlap_[i] *= filter.over_sigma(svd_.sigma[i], spectrum);
  out.head(size).noalias() = svd_.Vt.transpose() * overlap_;
}

// The length of a step with these coefficients: ‖S c‖, or ‖Jᵀ S c‖ = ‖T B c‖.
Real LanczosStep::distance(const Vector& coefficients) const {
  if (is_over_parameters_) return coefficients.norm();
  return (bidiagonal(alpha_, beta_, vectors_) * coefficients).norm();
}

bool LanczosStep::add(Meter& f, Linearization& at, const SpectralFilter& filter,
                      const KrylovLimits& limits, const Vector& w, Real factor, Vector& out) {
  constexpr Index kFirstLook = 6;
  unknowns_ = out.size();
  is_over_parameters_ = unknowns_ <= w.size();
  const Index r = std::min(w.size(), out.size());
  const auto room = static_cast<Index>(kMostBytes / (sizeof(Real) * static_cast<Real>(r)));
  start(at, w, std::clamp<Index>(std::min(limits.vectors, r), 1, std::max<Index>(room, 1)));
  if (!std::isfinite(length_)) return false;
  if (length_ == 0) return true;
  Index next_look = kFirstLook;
  bool is_open = true;
  error_ = 1;
  while (is_open && error_ > limits.tolerance) {
    is_open = extend(at) && !f.is_spent();
    if (is_open && vectors_ < next_look) continue;
    next_look = vectors_ + std::max<Index>(1, vectors_ / 8);
    solve(filter, vectors_, solution_);
    solve(filter, 2 * vectors_ / 3, earlier_);
    const Real length = distance(solution_);
    // A space that no product leaves holds the step itself.
    error_ = length > 0 && !is_exhausted_ ? distance(solution_ - earlier_) / length : 0;
  }
  if (vectors_ == 0 || !is_finite(solution_)) return vectors_ == 0;
  s_.noalias() = S_.leftCols(vectors_) * solution_;
  if (!is_over_parameters_) apply(at, false, s_, t_);
  out += factor * (is_over_parameters_ ? s_ : t_);
  return true;
}

// The eigenvalues of JJᵀ in two parts, and the step by both.

namespace {

// For the cut-off: σ that cannot be kept, however they are rounded. S omits them if the
// second-order term in ε σ₁²/σ², which couples them to those kept, vanishes.
constexpr Real kFarBelow = 0.01, kLeastCutoff = 3e-6;

}  // namespace

bool SplitGram::solve(LayeredJacobian& J, const SymmetricEigen& eigen, const SpectralFilter& filter,
                      const Spectrum& spectrum, const Vector& w, Vector& out) {
  const Index r = w.size();
  if (spectrum.largest == 0) {
    for (Vector* zero : {&sigma_, &along_, &out}) zero->setZero(r);
    return true;
  }
  const auto count_below = [&](Real share) {
    const Real bound = share * spectrum.largest, *lambda = eigen.lambda.data();
    return std::lower_bound(lambda, lambda + r, bound * bound) - lambda;
  };
  const bool discards = filter.cutoff >= kLeastCutoff && !filter.clamps;
  const Index n3 = discards ? count_below(kFarBelow * filter.cutoff) : 0;
  const Index n2 = std::max(count_below(kSplit), n3) - n3, n1 = r - n3 - n2;
  const Eigen::Ref<const Matrix> V3 = eigen.V.leftCols(n3), V1 = eigen.V.rightCols(n1);
  V2_ = eigen.V.middleCols(n3, n2);
  J.pullback(V2_, Z_);
  small_.V.resize(n2, n2);
  lower_gram(Z_, small_.V);
  if (n2 > 0 && !symmetric_eigen(Matrix(small_.V), small_)) return false;
  sigma_ = eigen.lambda.cwiseMax(0).cwiseSqrt();
  if (n2 > 0) sigma_.segment(n3, n2) = small_.lambda.cwiseMax(0).cwiseSqrt();

  // a = Vᵀ w, and what first order adds to a₂.
  const Vector a = eigen.V.transpose() * w;
  const Vector lambda1 = eigen.lambda.tail(n1);
  pair_.resize(r, 2);
  pair_.col(0).noalias() = V1 * a.tail(n1).cwiseQuotient(lambda1);
  pair_.col(1).noalias() = V3 * a.head(n3);
  J.pullback(pair_, z_);
  Vector b = small_.V.transpose() * (a.segment(n3, n2) - Z_.transpose() * z_.col(0));
  Vector shift = small_.V.transpose() * (Z_.transpose() * z_.col(1));
  for (Index i = 0; i < n2; ++i) {
    const Real sigma = sigma_[n3 + i], h = filter.over_sigma(sigma, spectrum);
    const Real inverse = n3 > 0 && h > 0 ? 1 / (sigma * sigma) : 0;
    b[i] = h * (b[i] + inverse * shift[i]);
    shift[i] = inverse * b[i];
  }
  along_.setZero(r);
  along_.segment(n3, n2) = b.cwiseProduct(sigma_.segment(n3, n2));

  // And what it adds to a₁ and to V.
  const Vector of_small = small_.V * b;
  triple_.resize(Z_.rows(), 3);
  triple_.col(0).noalias() = Z_ * a.segment(n3, n2) + z_.col(1);
  triple_.col(1).noalias() = Z_ * of_small;
  triple_.col(2).noalias() = Z_ * (small_.V * shift);
  J.pushforward(triple_, Y_);
  Vector c = a.tail(n1) + (V1.transpose() * Y_.col(0)).cwiseQuotient(lambda1);
  for (Index i = 0; i < n1; ++i) c[i] *= filter.over_sigma(sigma_[r - n1 + i], spectrum);
  along_.tail(n1) = c.cwiseProduct(sigma_.tail(n1));
  c -= (V1.transpose() * Y_.col(1)).cwiseQuotient(lambda1);
  out.noalias() = V1 * c + V2_ * of_small + V3 * (V3.transpose() * Y_.col(2));
  return true;
}

// One spectral step by each of its factorizations.

namespace {

constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

bool has_layers(const Meter& f) { return f.is_granted(Oracle::layer_factors); }

}  // namespace

void SpectralStep::start(Meter& f) const {
  if (wanted_ == Factorization::lanczos)
    f.name_series({"Krylov vectors of a step", "estimated relative error of a step"});
}

bool SpectralStep::add(Meter& f, Linearization& at, const SpectralFilter& filter, const Vector& w,
                       Real factor, Vector& out) {
  const bool is_wide = w.size() < out.size();
  const bool has_jacobian = f.is_granted(Oracle::jacobian);
  Factorization factorization = wanted_;
  if (factorization == Factorization::automatic)
    factorization = filter.clamps && has_jacobian                               ? Factorization::svd
                    : (was_too_small_ || never_by_gram(filter)) && has_jacobian ? Factorization::qr
                    : is_tikhonov(filter)      ? Factorization::cholesky
                    : is_wide && has_layers(f) ? Factorization::layers
                                               : Factorization::gram;
  bool is_done = false;
  if (factorization == Factorization::gram || factorization == Factorization::layers ||
      factorization == Factorization::split || factorization == Factorization::cholesky) {
    const Outcome outcome = by_gram(factorization, f, at, filter, w, factor, out);
    is_done = outcome == Outcome::done;
    if (outcome == Outcome::too_small) factorization = Factorization::qr;
  }
  if (factorization == Factorization::svd) is_done = by_svd(at.jacobian(), filter, w, factor, out);
  if (factorization == Factorization::qr &&
      (is_done = by_qr(at.jacobian(), filter, w, factor, out)))
    judge(is_wide && has_layers(f) ? Factorization::split : Factorization::gram, filter, is_wide,
          w.norm());
  if (factorization == Factorization::orthogonal &&
      (is_done = least_squares(at.jacobian(), w, filter.cutoff, result_)))
    out += factor * result_;
  if (factorization == Factorization::lanczos) {
    is_done = lanczos_.add(f, at, filter, limits_, w, factor, out);
    f.note(0, static_cast<Real>(lanczos_.vectors()));
    f.note(1, lanczos_.error());
  }
  const std::uint32_t bit = 1U << static_cast<unsigned>(factorization);
  std::string words;
  if (!is_done) {
    words = "the Jacobian has no singular values in finite numbers";
  } else if ((factorizations_used_ & bit) == 0) {  // add its name, in the order of the table
    factorizations_used_ |= bit;
    for (const FactorizationRow& row : kFactorizations)
      if ((factorizations_used_ & (1U << static_cast<unsigned>(row.factorization))) != 0)
        words += fmt::format("{}{}", words.empty() ? "steps by " : ", and by ", row.words);
  }
  if (!words.empty()) f.claim(words);
  return is_done;
}

bool SpectralStep::by_svd(const Matrix& J, const SpectralFilter& filter, const Vector& w,
                          Real factor, Vector& out) {
  if (!thin_svd(J, svd_)) return false;
  spectrum_ = {svd_.sigma[0], svd_.sigma.squaredNorm() / static_cast<Real>(J.rows())};
  along_.noalias() = svd_.U.transpose() * w;
  for (Index i = 0; i < along_.size(); ++i) along_[i] *= filter(svd_.sigma[i], spectrum_);
  out.noalias() += factor * svd_.Vt.transpose() * along_;
  return true;
}

// J = Aᵀ, A = U' diag(σ) V'ᵀ, where J is wide: V f(σ) Uᵀ w = U' f(σ) V'ᵀ w.
bool SpectralStep::by_qr(const Matrix& J, const SpectralFilter& filter, const Vector& w,
                         Real factor, Vector& out) {
  const bool is_wide = J.rows() < J.cols();
  if (is_wide) tall_ = J.transpose();
  if (!is_finite(w) || !factored_.factor(is_wide ? tall_ : J)) return false;
  const Vector& sigma = factored_.sigma();
  spectrum_ = {sigma[0], sigma.squaredNorm() / static_cast<Real>(J.rows())};
  is_wide ? factored_.to_right(w, along_) : factored_.to_left(w, along_);
  for (Index i = 0; i < along_.size(); ++i) along_[i] *= filter(sigma[i], spectrum_);
  is_wide ? factored_.from_left(along_, result_) : factored_.from_right(along_, result_);
  out += factor * result_;
  sigma_ = sigma;
  return true;
}

SpectralStep::Outcome SpectralStep::by_gram(Factorization& factorization, Meter& f,
                                            Linearization& at, const SpectralFilter& filter,
                                            const Vector& w, Real factor, Vector& out) {
  const bool is_wide = w.size() < out.size();
  const bool is_layered = is_wide && factorization != Factorization::gram &&
                          (factorization != Factorization::cholesky || has_layers(f));
  form_gram(is_layered, is_wide, at, w);
  spectrum_.mean_square = gram_.trace() / static_cast<Real>(w.size());
  const bool is_solved = factorization == Factorization::cholesky
                             ? solve_damped(filter)
                             : solve_filtered(filter, is_wide, w.norm());
  if (!is_solved) return Outcome::failed;
  if (wanted_ == Factorization::automatic && was_too_small_ &&
      factorization == Factorization::layers)
    factorization = Factorization::split;
  if (factorization == Factorization::split) {
    if (!split_.solve(layered_, eigen_, filter, spectrum_, w, result_)) return Outcome::failed;
    sigma_ = split_.sigma();
    along_ = split_.along();
    judge(Factorization::split, filter, true, w.norm());
  }
  if (wanted_ == Factorization::automatic && was_too_small_ && f.is_granted(Oracle::jacobian))
    return Outcome::too_small;
  if (!is_wide) {
    out += factor * result_;
  } else if (is_layered) {
    cotangent_ = result_.reshaped(at.y().rows(), at.y().cols());
    gradient_.resize(out.size());
    at.pullback(cotangent_, gradient_);
    out += factor * gradient_;
  } else {
    out.noalias() += factor * (at.jacobian().transpose() * result_);
  }
  return Outcome::done;
}

// K = JJᵀ and w where J is wide, else JᵀJ and Jᵀw.
void SpectralStep::form_gram(bool is_layered, bool is_wide, Linearization& at, const Vector& w) {
  if (is_layered) {
    layered_.take(at);
    layered_.gram(gram_);
  } else {
    const Matrix& J = at.jacobian();
    const Index r = is_wide ? J.rows() : J.cols();
    gram_.resize(r, r);
    product(is_wide ? Form::A_BH : Form::AH_B, J, J, gram_);
  }
  if (is_wide)
    right_ = w;
  else
    right_.noalias() = at.jacobian().transpose() * w;
}

// From eigenvalues σ², by f(σ)/σ.
bool SpectralStep::solve_filtered(const SpectralFilter& filter, bool is_wide, Real length) {
  if (!symmetric_eigen(gram_, eigen_)) return false;
  const Index r = eigen_.lambda.size();
  sigma_ = eigen_.lambda.cwiseMax(0).cwiseSqrt();
  spectrum_.largest = sigma_[r - 1];
  along_.noalias() = eigen_.V.transpose() * right_;
  for (Index i = 0; i < r; ++i) along_[i] *= filter.over_sigma(sigma_[i], spectrum_);
  result_.noalias() = eigen_.V * along_;
  if (is_wide) along_.array() *= sigma_.array();  // of the step, as it is where J is tall
  judge(Factorization::gram, filter, is_wide, length);
  return true;
}

// σ₁² is at most Frobenius' norm of the Gram matrix, of which the lower half is there: the
// condition number of what is factorized is at most that over μ.
bool SpectralStep::solve_damped(const SpectralFilter& filter) {
  const Real mu = filter.mu(spectrum_);
  Real squares = -gram_.diagonal().squaredNorm();
  for (Index j = 0; j < gram_.cols(); ++j)
    squares += 2 * gram_.col(j).tail(gram_.rows() - j).squaredNorm();
  const Real largest = std::sqrt(squares);
  gram_.diagonal().array() += mu;
  column_ = right_;
  if (!solve_positive_definite(gram_, column_)) return false;
  result_ = column_.col(0);
  was_too_small_ = !(mu > 0 && kEpsilon * largest / mu <= kMostErrorByGram);
  return true;
}

// Whether the squares of singular values are not enough for a step with the components along_ in
// the basis V. What a Gram matrix is rounded by, ε σ₁², changes the i-th component by a share
// ε q σ₁²/(σᵢ² + μ), as −h' changes h(σ²) = f(σ)/σ; and turns into the i-th component of w a part
// ε σ₁²/σⱼ² of a larger one j, and a part ε σ₁²/σᵢ² of all that is discarded. Where J is tall, Jᵀw
// is rounded by ε σ₁‖w‖ instead. Of a Gram matrix that is split, s σ₁ stands for σ₁ among the small
// ones, and of what turns large ones a share s is left. What J is rounded by itself does not count,
// since a SVD of it is off by that too.
void SpectralStep::judge(Factorization factorization, const SpectralFilter& filter, bool is_wide,
                         Real length) {
  const Real mu = filter.mu(spectrum_), largest = spectrum_.largest, q = (filter.kappa + 1) / 2;
  const Index r = along_.size();
  const bool is_ascending = sigma_[0] < sigma_[r - 1],
             is_split = factorization == Factorization::split;
  const auto at = [&](Index step) { return is_ascending ? r - 1 - step : step; };  // largest first
  const auto is_kept = [&](Index i) { return filter.keeps(sigma_[i], spectrum_); };
  Real discarded = length * length;
  for (Index i = 0; i < r; ++i)
    if (is_kept(i)) discarded -= std::pow(along_[i] / filter(sigma_[i], spectrum_), 2);
  discarded = std::max(discarded, Real(0));
  Real error = 0, turned = 0, least = largest;
  for (Index step = 0; step < r && is_kept(at(step)); ++step) {
    const Index i = at(step);
    least = sigma_[i];
    const Real h = filter.over_sigma(least, spectrum_), f = least * h;
    const Real square = least * least + mu, whole = largest * largest / square;
    const bool is_large = least >= kSplit * largest;
    const Real share = is_split && !is_large ? kSplit * kSplit * whole : whole;
    const Real turn = is_split && is_large ? kSplit * whole : share;
    const Real spill =
        is_wide ? f * std::sqrt(turned + turn * turn * discarded) : largest * h * length;
    error += std::pow(q * share * along_[i], 2) + spill * spill;
    turned += std::pow(turn * along_[i] / f, 2);
  }
  const Real share = std::max(least, std::sqrt(mu)) / largest;
  estimate_ = kEpsilon * std::sqrt(error) / along_.norm();
  was_too_small_ = !(share >= (is_split ? kLeastShareBySplit : kLeastShareByGram) &&
                     estimate_ <= kMostErrorByGram);
}

}  // namespace isoline::optimizers
