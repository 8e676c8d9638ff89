// Rank and Gauss-Newton step by the singular values of J D⁻¹, D the norms of J's columns.
#include "optimizers/examination.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/decompose.h"
#include "core/differences.h"

namespace isoline::optimizers {

std::string doubt_of(const LeastSquaresPoint& at) {
  constexpr Real kRounding = std::numeric_limits<Real>::epsilon();
  // Shares of its standard deviation, and of the error that the noise of a call gives it where the
  // fit is as good as that: more leaves it undetermined.
  constexpr Real kOfSpread = 0.1, kOfError = 2;
  std::vector<Index> free;
  for (Index i = 0; i < at.theta.size(); ++i)
    if (!at.is_held[static_cast<std::size_t>(i)]) free.push_back(i);
  if (free.empty()) return "";
  const Index m = at.J.rows(), n = std::ssize(free);
  const Matrix J = at.J(Eigen::all, free);
  if (!is_finite(J) || !is_finite(at.residual)) return "its Jacobian is not finite";
  const Vector D = J.colwise().norm();                                           // (n)
  const Real error = at.noise * at.size_of_y / std::sqrt(static_cast<Real>(m));  // of an entry of y
  const Real step = at.has_exact_jacobian ? 1  // of its differences
                    : at.is_central       ? central_step(at.noise)
                                          : std::sqrt(at.noise);
  const auto size_of = [&](Index i) {
    return std::max(std::abs(at.theta[free[i]]), at.sizes[free[i]]);
  };
  std::string without;
  for (Index i = 0; i < n; ++i)
    if (!(D[i] * size_of(i) * step > 2 * at.noise * at.size_of_y))
      without += (without.empty() ? "" : " and ") + name_of_unknown(at.names, free[i]);
  if (const bool are_several = without.find(" and ") != std::string::npos; !without.empty())
    return without + (are_several ? " have" : " has") + " no effect here";
  Svd svd;
  if (!thin_svd(J * D.cwiseInverse().asDiagonal(), svd))
    return "its Jacobian has no singular values";
  const Vector& sigma = svd.sigma;
  const Index rank = std::min(m, n);
  const Real least = at.has_exact_jacobian ? static_cast<Real>(std::max(m, n)) * kRounding
                     : at.is_central       ? step * step
                                           : step;
  if (!(sigma[rank - 1] > least * sigma[0])) {
    const auto direction = svd.Vt.row(rank - 1).cwiseAbs();  // which does not change y
    constexpr Real kSmall = 0.1;
    std::string names;
    Index count = 0;
    for (Index i = 0; i < n; ++i)
      if (direction[i] >= kSmall * direction.maxCoeff())
        names += (count++ > 0 ? " and " : "") + name_of_unknown(at.names, free[i]);
    return fmt::format("its Jacobian does not have full rank: {} of {} give{} the same y",
                       count > 1 ? "other values" : "another value", names, count > 1 ? "" : "s");
  }
  const Vector along = -(svd.U.transpose() * at.residual).cwiseQuotient(sigma);
  const Vector move = D.cwiseInverse().cwiseProduct(svd.Vt.transpose() * along);
  const Real r = at.residual.norm();
  const Real spread = m > n ? r / std::sqrt(static_cast<Real>(m - n)) : 0;
  const Matrix root = svd.Vt.transpose() * sigma.cwiseInverse().asDiagonal();
  // Errors of the entries of D⁻¹ Jᵀ r by those of J: of the noise, and of the bends of y over
  // central steps.
  Vector slope_errors(n);
  for (Index i = 0; i < n; ++i)
    slope_errors[i] = error / (step * size_for_steps(size_of(i), D[i], at.size_of_y)) * r / D[i] +
                      (at.is_central && at.forgives_noise ? step * step * r : 0);
  const Matrix spreads = (root * root.transpose()) * slope_errors.asDiagonal();
  for (Index i = 0; i < n; ++i) {
    const Real enough_of_unknown =
        kEnoughOfUnknown * least_size(at.theta[free[i]], at.sizes[free[i]]);
    const Real length = root.row(i).norm() / D[i];
    const Real unsure = std::hypot(error * length, spreads.row(i).norm() / D[i]);
    const bool forgives = at.forgives_noise || at.is_central;
    const Real most = std::max(kOfSpread * spread, kOfError * error) * length;
    const Real of_noise = forgives ? std::min(at.sure * unsure, most) : 0;
    const Real known = std::max(enough_of_unknown, at.enough_of_deviation * spread * length);
    const Real enough = std::max(known, of_noise);
    const bool is_blurred =
        !forgives && !at.has_exact_jacobian && std::sqrt(static_cast<Real>(m)) * unsure > known;
    if (is_blurred || !(std::abs(move[i]) <= enough))
      return fmt::format("gradient not small: the Gauss-Newton step moves {} by {:.2g} of its {}",
                         name_of_unknown(at.names, free[i]),
                         spread > 0 ? move[i] / (spread * length) : move[i] / size_of(i),
                         spread > 0 ? "standard deviation" : "size");
  }
  return "";
}

}  // namespace isoline::optimizers
