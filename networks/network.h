// A differentiable map θ ↦ x = N(input; θ). Parameters are one flat vector; columns are samples.
// Const: the results of a forward pass live in the caller's Workspace, and the products are taken
// at the (θ, input) of the last forward.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/array.h"
#include "core/random.h"
#include "core/workspace.h"
#include "networks/network_entry.h"

namespace isoline::networks {

// One array of parameters within θ: `rows` by `columns`, column major, from `offset`. A convolution
// has the taps of one pair of channels in each column; a spectrum has one mode in each column, in
// which two rows are the real and imaginary part of one pair of channels.
struct Block {
  enum class Kind { input, weight, bias, convolution, spectrum, norm };
  Index offset, rows, columns;
  Kind kind;
};

// One dense layer z = W a + b under a cotangent: the gradient of W is G Aᵀ and that of b is G 1. A
// network that carries derivatives along with its values has several lanes per sample, first the
// values of all samples, then B columns for each further lane, to which b is not added.
struct LayerFactor {
  Index weight, bias;  // the blocks of layout() that hold W and b
  Matrix inputs;       // A, (columns of W, lanes·B)
  Matrix cotangents;   // G, (rows of W, lanes·B)
};

// The moments of one convolution under a cotangent, at all places t of its grid: with ā = (a, 1)
// the patch that the kernel multiplies, in the order of the block's rows, and g the cotangent of
// its output there, ⟨Σ_t ā āᵀ⟩ over samples and ⟨g gᵀ⟩ over samples and places.
struct LayerMoments {
  Index weight, bias;  // the blocks of layout() that hold the kernel and b
  Matrix inputs;       // (taps · channels in + 1)²
  Matrix cotangents;   // (channels out)²
};

class Network {
 public:
  virtual ~Network() = default;

  virtual Index parameters() const = 0;           // n
  virtual Index inputs() const = 0;               // i
  virtual Index outputs() const = 0;              // k
  virtual Vector start(RandomStream&) const = 0;  // θ₀, (n)
  virtual std::vector<Block> layout() const = 0;
  virtual bool is_identity() const { return false; }
  // Properties that tests use: x_b depends only on column b of the input (not with batch norm); the
  // tolerance is 1e-5 instead of 1e-12; steps across a nondifferentiable point are resampled.
  virtual bool has_independent_samples() const { return true; }
  virtual bool is_single_precision() const { return false; }
  virtual bool has_kinks() const { return false; }

  virtual void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const = 0;
  virtual void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const = 0;  // (n) -> (k, B)
  virtual void pullback(BatchRef u, VectorOut JTu, Workspace& w) const = 0;    // (k, B) -> (n)

  // (d/dε) N'(θ + ε v)ᵀ (u + ε du) at ε = 0, exactly, by forward over reverse: u, du (k, B) -> (n).
  // v is that of the last pushforward on this workspace, whose tangents are used.
  virtual bool has_curvature() const { return false; }
  virtual void curvature(VectorRef, BatchRef, BatchRef, VectorOut, Workspace&) const {
    throw std::logic_error("this network has no second derivatives");
  }

  // ∂y/∂θ of all samples stacked, (m·B, n), from ∂y/∂x of each side by side, (m, k·B). By default
  // one pullback per row.
  virtual void jacobian(BatchRef dy_dx, BatchOut J, Workspace& w) const;

  // The factors of each dense layer, in order, under the cotangent u (k, B).
  virtual bool has_layer_factors() const { return false; }
  virtual void layer_factors(BatchRef, std::vector<LayerFactor>&, Workspace&) const {
    throw std::logic_error("this network has no dense layers");
  }

  // The moments of each convolution, in order, under the cotangent u (k, B), and its pullback.
  virtual bool has_layer_moments() const { return false; }
  virtual void layer_moments(BatchRef, std::vector<LayerMoments>&, VectorOut, Workspace&) const {
    throw std::logic_error("this network has no convolutions");
  }

  // Evaluation of trained parameters. Where the forward pass depends on statistics of its batch,
  // `statistics` gives those of a batch, to be averaged, and `infer` is given the average.
  virtual Vector statistics(VectorRef, BatchRef, Workspace&) const { return {}; }
  virtual void infer(VectorRef theta, VectorRef, BatchRef in, BatchOut x, Workspace& w) const {
    forward(theta, in, x, w);
  }
};

// A network from "mlp[layers=32-64-32]"; UsageError where it does not fit the shape.
std::unique_ptr<Network> make_network(const std::string& spec, const NetworkShape& shape);

// The identity network x = θ: with it a learning problem is the direct optimization of one x.

class Identity final : public Network {
 public:
  explicit Identity(Vector start) : start_(std::move(start)) {}
  Index parameters() const override { return start_.size(); }
  Index inputs() const override { return 0; }
  Index outputs() const override { return start_.size(); }
  Vector start(RandomStream&) const override { return start_; }
  std::vector<Block> layout() const override { return {{0, start_.size(), 1, Block::Kind::input}}; }
  bool is_identity() const override { return true; }

  void forward(VectorRef theta, BatchRef, BatchOut x, Workspace&) const override {
    x.col(0) = theta;
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace&) const override { Jv.col(0) = v; }
  void pullback(BatchRef u, VectorOut JTu, Workspace&) const override { JTu = u.col(0); }
  bool has_curvature() const override { return true; }
  void curvature(VectorRef, BatchRef, BatchRef du, VectorOut out, Workspace&) const override {
    out = du.col(0);
  }

 private:
  Vector start_;
};

}  // namespace isoline::networks
