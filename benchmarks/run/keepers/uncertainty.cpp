// x at the returned point of a direct least-squares problem with more residuals than unknowns, and
// its covariance. Those that a bound holds are constants, and have none. By the singular values of
// A = J D⁻¹, D the norms of J's columns: (JᵀJ)⁻¹ = D⁻¹ V Σ⁻² Vᵀ D⁻¹, without the squares of their
// condition number. Where J does not have full rank, x has no such covariance.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "benchmarks/run/keepers/keeper.h"
#include "core/array.h"
#include "core/decompose.h"

namespace isoline::benchmarks {
namespace {

struct Covariance {
  static constexpr int kUnknowns = 64;
  int unknowns = 0;  // 0: nothing is kept
  std::int64_t degrees_of_freedom = 0;
  double variance, condition;  // σ̂²; of J, its columns scaled to norm 1
  double x[kUnknowns], deviation[kUnknowns], correlation[kUnknowns][kUnknowns];

  void end(Meter& f, Status verdict) {
    const problems::Problem& problem = f.problem();
    const Index m = problem.residuals(), all = problem.unknowns();
    if (verdict == Status::unconfirmed || verdict == Status::failed ||
        !problem.is_least_squares() || problem.is_learned() || !problem.has_identity_network() ||
        problem.samples() != 1 || all > kUnknowns || !std::isfinite(f.judged_point().loss) ||
        (!problem.offers().contains(Oracle::jacobian) && !f.knows_jacobian()))
      return;
    const auto are_too_few = [&](Index count) {
      if (m < count && problem.is_elsewhere())  // a user reads it
        f.remark(fmt::format("{} data do not determine {} unknowns: others explain them as well", m,
                             count));
      return m <= count;
    };
    if (problem.bounds() == nullptr && are_too_few(all)) return;
    const Matrix* const known = f.jacobian_at_end();
    if (known == nullptr) return f.remark("no calls were left for standard deviations");
    const Vector r = (f.judged_point().y - problem.target()).reshaped(),
                 slope = known->transpose() * r;
    std::vector<Index> free;
    for (Index i = 0; i < all; ++i)
      if (!f.is_held(i, slope)) free.push_back(i);
    const auto n = static_cast<Index>(free.size());
    if (n == 0 || are_too_few(n)) return;
    const Matrix J = (*known)(Eigen::all, free);  // (m, n)
    const Vector D = J.colwise().norm();          // (n)
    Svd svd;
    if (!is_finite(J) || !(D.minCoeff() > 0) || !thin_svd(J * D.cwiseInverse().asDiagonal(), svd))
      return;
    const Vector& sigma = svd.sigma;
    if (!(sigma[n - 1] > static_cast<Real>(m) * std::numeric_limits<Real>::epsilon() * sigma[0]))
      return;
    Matrix root = svd.Vt.transpose() * sigma.cwiseInverse().asDiagonal();  // A's, (n, n)
    const Vector lengths = root.rowwise().norm();
    root.array().colwise() /= lengths.array();
    degrees_of_freedom = m - n;
    variance = (f.judged_point().y - problem.target()).squaredNorm() / static_cast<Real>(m - n);
    condition = sigma[0] / sigma[n - 1];
    const Vector own_x = problem.in_own_units(f.judged());
    if (own_x.size() > kUnknowns) return;
    std::ranges::copy(own_x, x);
    unknowns = static_cast<int>(own_x.size());
    add_deviations(f, free, D, lengths, root * root.transpose());
  }

  // `lengths` are those of the rows of A's root, `own` the correlations of the free unknowns.
  void add_deviations(const Meter& f, const std::vector<Index>& free, const Vector& D,
                      const Vector& lengths, const Matrix& own) {
    const problems::Problem& problem = f.problem();
    const auto n = static_cast<Index>(free.size());
    for (Index i = 0; i < unknowns; ++i) {
      deviation[i] = std::nan("");
      for (Index j = 0; j < unknowns; ++j) correlation[i][j] = i == j ? 1 : std::nan("");
    }
    if (problem.model() != nullptr) {  // C = S C_θ Sᵀ
      const Vector deviations = std::sqrt(variance) * lengths.array() / D.array();
      const Matrix S =
          Matrix(problem.model_slopes(f.judged())(Eigen::all, free)) * deviations.asDiagonal();
      const Matrix C = S * own * S.transpose();
      for (Index i = 0; i < unknowns; ++i) {
        if (!(C(i, i) > 0)) continue;
        deviation[i] = std::sqrt(C(i, i));
        for (Index j = 0; j < unknowns; ++j)
          if (i != j && C(j, j) > 0) correlation[i][j] = C(i, j) / std::sqrt(C(i, i) * C(j, j));
      }
      return;
    }
    const Vector& scales = problem.own_units().scales;
    for (Index l = 0; l < n; ++l) {
      const Index i = free[static_cast<std::size_t>(l)];
      const Real scale = scales.size() > 0 ? scales[i] : 1;
      deviation[i] = scale * std::sqrt(variance) * lengths[l] / D[l];
      for (Index o = 0; o < n; ++o)
        if (l != o)
          correlation[i][free[static_cast<std::size_t>(o)]] = own(std::max(l, o), std::min(l, o));
    }
  }

  std::string defect() const {
    return is_within(unknowns, kUnknowns) ? "" : "standard deviations of an invalid size";
  }

  void write(const Trace&, Parts& parts) const {
    if (unknowns == 0) return;
    const auto first = [&](const double* values) {
      return std::vector<Real>(values, values + unknowns);
    };
    parts.uncertainty = Uncertainty{.x = first(x),
                                    .standard_deviation = first(deviation),
                                    .correlation = {},
                                    .variance = variance,
                                    .degrees_of_freedom = degrees_of_freedom,
                                    .condition = condition};
    for (int i = 0; i < unknowns; ++i)
      parts.uncertainty->correlation.push_back(first(correlation[i]));
  }
};

}  // namespace

Keeper uncertainty_keeper() { return keeper_of<Covariance>(); }

}  // namespace isoline::benchmarks
