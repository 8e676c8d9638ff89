// The samples of one evaluation, and where those of a learning problem come from.
#pragma once

#include <functional>

#include "core/array.h"
#include "core/random.h"

namespace isoline::problems {

// One sample a column.
struct Batch {
  Matrix input;    // what the network sees, (i, B)
  Matrix context;  // c, (p, B), empty for most
  Matrix target;   // y*, (m, B)
  Matrix truth;    // the x* that made y*, (k, B), empty where there is none

  Index samples() const { return target.cols(); }
  void resize(Index inputs, Index contexts, Index outputs, Index truths, Index samples) {
    input.resize(inputs, samples);
    context.resize(contexts, contexts > 0 ? samples : 0);
    target.resize(outputs, samples);
    truth.resize(truths, truths > 0 ? samples : 0);
  }
};

// The distribution that a learning problem is posed over.
struct Samples {
  Index batch = 0;          // B, drawn anew each step; 0: a direct problem
  Index data = 0;           // N: the same N samples at every step instead
  Index epoch = 0;          // N: batches are consecutive slices of the same N, a multiple of B
  Index validation = 1024;  // samples that the curves are measured on
  Index contexts = 0;       // p
  bool has_truth = true;    // whether `draw` fills Batch::truth
  std::function<RandomStream(std::string_view purpose)> stream = {};
  // Fills column b of every array of the batch from the sample's own stream.
  std::function<void(RandomStream& stream, Index b, Batch& batch)> draw = {};
};

}  // namespace isoline::problems
