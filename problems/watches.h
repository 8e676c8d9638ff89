// What learning problems trace besides their curves: quantities of θ on the samples that judge.
// They are taken at kept iterations, off the clock, and no method sees them.
#pragma once

#include "problems/problem.h"

namespace isoline::problems {

// The names of both, the values of `first` first.
Series joined(Series first, Series second);

// Mean and spread of the values of the hidden neurons over the samples, all layers together; empty
// where the network has no layers of neurons.
Series hidden_activity(const Network& network);

// How many hidden neurons are saturated, and mean and spread of the first `shown` of the last
// layer. A neuron is saturated whose value is 1 or −1 for every sample, or, of one that rectifies,
// 0: it gives the network no more than a bias, and its weights no gradient. The mean over all
// neurons can't show that, for some saturate at 1 and others at −1; nor can a spread of 0 alone,
// which a neuron of small weights has too, and learns.
Series saturation(const Network& network, Index shown);

// The components of y that are named, of the sample that `which` chooses.
Series path(std::vector<std::string> names, std::function<Index(const Batch& batch)> which);

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
