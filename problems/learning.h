// The learning problem over a physics: x = N(y*; θ) for every y* of a distribution. Its options are
// the same for all, so a problem names them once:
//
//   struct Options { Real xi = 10; Learning learning{.network = "mlp"}; };
//   void fields(Options& o, auto& field) { field("xi", …); fields(o.learning, field); }
#pragma once

#include "core/options.h"
#include "problems/problem.h"

namespace isoline::problems {

struct Learning {
  std::string mode = "direct", network = "mlp", watch;
  Index batch = 100, data = 0;

  bool is_on() const { return mode == "learn"; }
};

inline void fields(Learning& o, auto& field) {
  field("mode", o.mode, {"direct", "learn"}, "one y*, or a network that learns x = N(y*; θ)");
  field("network", o.network, Choices{}, "network of mode=learn");
  field("batch", o.batch, between(1, 1e6), "samples drawn anew for each step of mode=learn");
  field("data", o.data, between(0, 1e6),
        "0: fresh samples each step; N: the same N samples at every step of mode=learn");
  field("watch", o.watch, {"", "noise", "spectrum"},
        "what mode=learn traces besides: noise: of gradients between batches; spectrum: of grids, "
        "the share of power by wave number");
}

// The published error of grids: |x − x*| summed over cells, the mean over samples.
Real summed_error(BatchRef x, const Batch& batch);

// Adds what learning needs to parts that hold the physics, `samples.draw` and the error in x: the
// network of that shape, its start, the streams, and the series. The network sees Batch::input.
ProblemParts learn(const Learning& options, const NetworkShape& shape, const Draw& draw,
                   ProblemParts parts);

}  // namespace isoline::problems
