// The ways to compute a spectral step, what each asks of a problem, and when a Gram matrix will do.
#pragma once

#include <string>
#include <string_view>

#include "optimizers/meter.h"
#include "optimizers/spectral_filter.h"

namespace isoline::optimizers {

enum class Way {
  automatic,
  svd,       // thin SVD of J, the reference
  qr,        // Jᵀ = QR, or J = QR where it is tall, and the SVD of R, without forming U and V
  gram,      // eigenvalues of the smaller Gram matrix, from J
  layers,    // eigenvalues of K = JJᵀ formed layer by layer, and one pullback
  split,     // the same, the small ones again from the part of J that belongs to them
  cholesky,  // of Tikhonov alone: (K + μ)⁻¹ or (JᵀJ + μ)⁻¹, which need no spectrum
  orthogonal,  // of 1/σ alone: J⁺ by a complete orthogonal factorization, the cut-off on its pivots
  lanczos,     // products with J and Jᵀ alone
};
Way way_named(std::string_view name);  // "auto", and each as it is called here

// What was done, in words: "the thin SVD of J".
std::string_view words_of(Way way);

// Of `automatic`. A Gram matrix squares the condition number: it is used where the estimated
// relative error of the step is at most 2e-9 by it, and the least σ that matters 1e-5 of the
// largest, or 1e-7 where it is split in two; and is not tried where the cut-off is too near its
// rounding for that to be seen.
inline constexpr Real kMostErrorByGram = 2e-9, kLeastShareByGram = 1e-5, kLeastShareBySplit = 1e-7;
inline constexpr Real kLeastCutoffByGram = 1e-7;

// Of `automatic`: whether no spectrum would let a Gram matrix be used.
bool never_by_gram(const SpectralFilter& filter);
// Whether one number is enough of a spectrum: Tikhonov's filter with μ in units of the mean.
bool is_tikhonov(const SpectralFilter& filter);

// What a method with a SpectralStep asks of a problem, by its way.
OracleSet needs_of(Way way, const SpectralFilter& filter, const Problem& problem);
// Why it can't treat a problem, in words; empty if it can.
std::string objection_to(Way way, const Problem& problem);

}  // namespace isoline::optimizers
