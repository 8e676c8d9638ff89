// Additional series of learning problems: quantities of θ on the validation samples.
// They are taken at kept iterations, off the clock, and no method sees them.
#pragma once

#include "core/options.h"
#include "problems/problem.h"

namespace isoline::problems {

// The names of both, the values of `first` first.
Series joined(Series first, Series second);

// Mean and spread of the values of the hidden neurons over the samples, all layers together; empty
// where the network has no layers of neurons.
Series hidden_activity(const Network& network);

// The number of saturated hidden neurons, and mean and spread of the first `shown` of the last
// layer. A neuron is saturated if its value is 1 or −1 for every sample, or 0 for a rectifier. It
// then acts as a constant, and its weights have no gradient. The mean over all neurons cannot show
// this, since some saturate at 1 and others at −1. Nor can a spread of 0 alone: a neuron with small
// weights has it, too, and still learns.
Series saturation(const Network& network, Index shown);
void add_neurons(ProblemParts& parts);  // both, without single neurons

// The components of y that are named, of the sample that `which` chooses.
Series path(std::vector<std::string> names, std::function<Index(const Batch& batch)> which);

// The shares of the power in bands of the wave number k = |k|, in cycles per cell: of x* − x, of
// the gradient ∂L/∂x, and of the update U = P⁻¹(y*; x) − x; means over samples, without the
// constant mode.
Series spectrum(Index grid);

// The learning problem over a physics: x = N(y*; θ) for every y* of a distribution. Its options are
// the same for all, so a problem names them once:
//
//   struct Options { Real xi = 10; Learning learning{.network = "mlp"}; };
//   void fields(Options& o, auto& field) { field("xi", …); fields(o.learning, field); }

struct Learning {
  std::string mode = kDirectMode, network = "mlp", watch, inputs;
  Index batch = 100, data = 0;

  bool is_on() const { return mode == kLearnMode; }
};

inline void fields(Learning& o, auto& field) {
  field(kModeOption, o.mode, {kDirectMode, kLearnMode},
        "one y*, or a network that learns x = N(y*; θ)");
  field(kNetworkOption, o.network, Choices{}, "network of mode=learn");
  field(kBatchOption, o.batch, between(1, 1e6),
        "samples per step of mode=learn, new ones in each step");
  field(kDataOption, o.data, between(0, 1e6),
        "0: new samples in each step; N: the same N samples in every step of mode=learn");
  field(kWatchOption, o.watch, {"", "noise", "spectrum"},
        "additional series of mode=learn: noise: differences of gradients between batches; "
        "spectrum, for grids: the share of power by wave number");
  field("inputs", o.inputs, {"", "shuffled"},
        "shuffled: as a null hypothesis, the network of mode=learn sees the y* of the next sample");
}

// Finding an x* (k) again from its exact data, y* = P(x*), of physics that are one to one, with 0
// as the standard start.
ProblemParts from_exact_data(std::unique_ptr<Physics> physics, const Vector& truth,
                             const Draw& draw, StartScale scale = StartScale::at_least_one);

// The published error of grids: |x − x*| summed over cells, the mean over samples.
Real summed_error(BatchRef x, const Batch& batch);

// A sample whose x* is drawn and whose y* = A x* is what the network sees.
std::function<void(RandomStream&, Index, Batch&)> sample_of(
    std::shared_ptr<const SelfAdjointPhysics> physics, std::function<Vector(RandomStream&)> truth);

// Adds what learning needs to parts that hold the physics, `samples.draw` and the error in x: the
// network of that shape, its start, the streams, and the series. The network sees Batch::input.
ProblemParts learn(const Learning& options, const NetworkShape& shape, const Draw& draw,
                   ProblemParts parts);

}  // namespace isoline::problems
