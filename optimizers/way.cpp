// Ways by name, and their needs.
#include "optimizers/way.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace isoline::optimizers {
namespace {

struct WayRow {
  Way way;
  std::string_view name, words;
};
constexpr WayRow kWays[] = {
    {Way::automatic, "auto", ""},
    {Way::svd, "svd", "the thin SVD of J"},
    {Way::qr, "qr", "QR and the SVD of R"},
    {Way::gram, "gram", "the Gram matrix of J"},
    {Way::layers, "layers", "the Gram matrix layer by layer"},
    {Way::split, "split", "the Gram matrix layer by layer, split in two"},
    {Way::cholesky, "cholesky", "Cholesky of the Gram matrix"},
    {Way::orthogonal, "orthogonal", "a complete orthogonal factorization"},
    {Way::lanczos, "lanczos", "Lanczos"},
};

}  // namespace

Way way_named(std::string_view name) {
  for (const WayRow& row : kWays)
    if (row.name == name) return row.way;
  throw UsageError(fmt::format("there is no way '{}' of a spectral step", name));
}

std::string_view words_of(Way way) { return kWays[static_cast<std::size_t>(way)].words; }

bool is_tikhonov(const SpectralFilter& filter) {
  return filter.kappa == 1 && filter.damping > 0 && filter.unit == SpectralFilter::Unit::mean;
}

// A damping in units of the mean is judged when it is known.
bool never_by_gram(const SpectralFilter& filter) {
  const bool is_relative = filter.unit == SpectralFilter::Unit::largest;
  return filter.clamps ||
         (is_relative && std::max(filter.cutoff, std::sqrt(filter.damping)) < kLeastCutoffByGram);
}

OracleSet needs_of(Way way, const SpectralFilter& filter, const Problem& problem) {
  const OracleSet by_matrix{Oracle::forward, Oracle::jacobian};
  const OracleSet by_layers{Oracle::forward, Oracle::layer_factors, Oracle::pullback};
  const bool has_layers =
      problem.residuals() < problem.unknowns() && problem.offers().contains(Oracle::layer_factors);
  const bool has_jacobian = problem.offers().contains(Oracle::jacobian);
  switch (way) {
    case Way::lanczos:
      return {Oracle::forward, Oracle::pullback, Oracle::pushforward};
    case Way::layers:
    case Way::split:
      return by_layers;
    case Way::cholesky:
      return has_layers ? by_layers : by_matrix;
    case Way::automatic: {
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

std::string objection_to(Way way, const Problem& problem) {
  const bool forms_K = way == Way::layers || way == Way::split;
  if (forms_K && problem.residuals() >= problem.unknowns())
    return fmt::format("way={} forms JJᵀ, and J is not wide: {} residuals, {} unknowns",
                       kWays[static_cast<std::size_t>(way)].name, problem.residuals(),
                       problem.unknowns());
  return "";
}

}  // namespace isoline::optimizers
