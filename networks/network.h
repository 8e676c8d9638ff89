// A differentiable map θ ↦ x = N(input; θ). Parameters are one flat vector; one sample a column.
#pragma once

#include <string>
#include <vector>

#include "core/array.h"
#include "core/random.h"
#include "core/workspace.h"

namespace isoline {

// One array of parameters within θ.
struct Block {
  enum class Kind { input, weight, bias, convolution, norm };
  Index offset, rows, columns;
  Kind kind;
};

class Network {
 public:
  virtual ~Network() = default;

  virtual Index parameters() const = 0;           // n
  virtual Index outputs() const = 0;              // k
  virtual Vector start(RandomStream&) const = 0;  // θ₀, (n)
  virtual std::vector<Block> layout() const = 0;
  virtual bool is_identity() const { return false; }

  virtual void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const = 0;
  virtual void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const = 0;  // (n) -> (k, B)
  virtual void pullback(BatchRef u, VectorOut JTu, Workspace& w) const = 0;    // (k, B) -> (n)
};

}  // namespace isoline
