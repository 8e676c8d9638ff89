// What learning problems trace besides their curves: quantities of θ on the samples that judge.
// They are taken at kept iterations, off the clock, and no method sees them.
#pragma once

#include "problems/problem.h"

namespace isoline::problems {

// The names of both, the values of `first` first.
Series joined(Series first, Series second);

// ½Σ(x − x*)² over the components, the mean over samples: what the published curves of grids show
// beside Σ|x − x*|.
Series half_squared_error();

// How far the gradients in θ of two batches differ at the same θ: of L, and of what SIP descends,
// (1/B) Σ ½‖x − x̃‖² with x̃ = P⁻¹(y*; x) held. The batches are the validation in parts of the size
// of a training batch, at most a quarter of it. `length` is the standard deviation of the
// gradients' norms over their mean, `direction` 1 − the mean cosine of two of them.
Series batch_noise();

// The shares of the power in bands of the wave number k = |k|, in cycles a cell, of what is missing
// in x, of the gradient ∂L/∂x, and of the update U = P⁻¹(y*; x) − x; means over samples. The
// constant is left out.
Series spectrum(Index grid);

}  // namespace isoline::problems
