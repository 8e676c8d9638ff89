// The loss L(y, y*) and its derivatives in y.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "core/array.h"
#include "core/errors.h"
#include "core/random.h"
#include "core/sparse.h"
#include "core/workspace.h"

namespace isoline::problems {

class Loss {
 public:
  virtual ~Loss() = default;
  // Whether it is a multiple of ‖y − y*‖², which methods of least squares descend.
  virtual bool is_least_squares() const { return true; }
  virtual Real value(BatchRef y, BatchRef target) const = 0;
  virtual void cotangent(BatchRef y, BatchRef target, BatchOut g) const = 0;  // ∂L/∂y, (m, B)
  // ∂²L/∂y² dy, (m, B) -> (m, B)
  virtual void curvature(BatchRef y, BatchRef target, BatchRef dy, BatchOut dg) const = 0;
};

// L = weight/B Σ ½‖y − y*‖²
class HalfSquared final : public Loss {
 public:
  explicit HalfSquared(Real weight = 1) : weight_(weight) {}
  Real value(BatchRef y, BatchRef target) const override {
    return 0.5 * scale(y) * (y - target).squaredNorm();
  }
  void cotangent(BatchRef y, BatchRef target, BatchOut g) const override {
    g = scale(y) * (y - target);
  }
  void curvature(BatchRef y, BatchRef, BatchRef dy, BatchOut dg) const override {
    dg = scale(y) * dy;
  }

 private:
  Real scale(BatchRef y) const { return weight_ / static_cast<Real>(y.cols()); }
  Real weight_;
};

// The samples of one evaluation, and where those of a learning problem come from.

// One sample per column.
struct Batch {
  Matrix input;    // what the network sees, (i, B)
  Matrix context;  // c, (p, B), empty for most
  Matrix target;   // y*, (m, B)
  Matrix truth;    // the x* that produced y*, (k, B), empty if unknown

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
  Index batch = 0;          // B, sampled in each step; 0: a direct problem
  Index data = 0;           // N: the same N samples at every step instead
  Index epoch = 0;          // N: batches are consecutive slices of the same N, a multiple of B
  Index validation = 1024;  // samples that the curves are measured on
  Index contexts = 0;       // p
  bool has_truth = true;    // whether `draw` sets Batch::truth
  std::function<RandomStream(std::string_view purpose)> stream = {};
  // Fills column b of every array of the batch from the sample's own stream.
  std::function<void(RandomStream& stream, Index b, Batch& batch)> draw = {};
};

// A differentiable process P : x (k, B) -> y (m, B), given a context c (p, B), often empty. One
// sample per column. Const: the results of a forward pass live in the caller's Workspace, and the
// products are taken at the x of the last forward, which the caller has stored in w.x.

// How far a local inverse can be trusted.
enum class Inverse {
  none,
  exact,        // P(P⁻¹(y; x₀)) = y
  damped,       // exact where the data carry evidence, held back elsewhere
  estimate,     // an informed guess, by how the data were made
  approximate,  // found from P itself, within an error: reversed steps, a few steps of a search
};

// The products with J that a physics offers, and their costs in forwards.
struct Products {
  bool has_pushforward = true, has_pullback = true;
  Index pushforward_price = 1, pullback_price = 1;
  bool are_differences = false;  // quotients of forwards, of some eight digits
  bool may_be_replaced = false;  // by a method's own differences: no user asked for these
  bool are_at_once = false;      // by forwards none of which needs the result of another
  Real noise = 0;  // of y in a call, relative to ‖y‖, where differences have found it
  Real step = std::numeric_limits<Real>::quiet_NaN();  // of those, relative to the unknowns' sizes
};

class Physics {
 public:
  virtual ~Physics() = default;

  virtual Index inputs() const = 0;   // k
  virtual Index outputs() const = 0;  // m

  virtual void forward(BatchRef x, BatchRef c, BatchOut y, Workspace& w) const = 0;
  // The next calls of forward() are at these samples, one each and in this order: a physics with
  // several workers begins to compute them at once.
  virtual void begin_forwards(BatchRef /*x*/) const {}
  virtual void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const = 0;  // (k, B) -> (m, B)
  virtual void pullback(BatchRef u, BatchOut JTu, Workspace& w) const = 0;    // (m, B) -> (k, B)

  // A physics without one of these products omits it here, and the harness never calls it.
  virtual Products products() const { return {}; }
  // Another process computes it; its time does not count as this process's time.
  virtual bool is_elsewhere() const { return false; }

  // J of each sample, side by side: (m, k·B). By default from the cheaper product.
  virtual void jacobian(BatchOut J, Workspace& w) const;

  // Where J of a sample is sparse: its pattern, which is fixed, and the values there.
  virtual const SparsePattern* sparse_pattern() const { return nullptr; }
  virtual void sparse_jacobian(VectorOut, Workspace&) const {
    throw NotApplicable("the physics declares no sparse Jacobian");
  }

  // Σᵢ uᵢ ∇²Pᵢ of each sample, side by side: (k, k·B), u (m, B).
  virtual bool has_curvature() const { return false; }
  virtual void curvature(BatchRef, BatchOut, Workspace&) const {
    throw NotApplicable("the physics offers no second derivatives");
  }
  // (Σᵢ uᵢ ∇²Pᵢ) v of each sample, (k, B). By default through the matrices.
  virtual void curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const;

  // The x nearest x0 with P(x) = y, for every sample that has one.
  virtual Inverse inverse_kind() const { return Inverse::none; }
  virtual Index inverse_price() const { return 1; }  // in forwards
  virtual Success local_inverse(BatchRef y, BatchRef /*x0*/, BatchRef /*c*/, BatchOut /*x*/) const {
    return Success::Constant(y.cols(), false);
  }
};

// Products by the Jacobian, which is formed once a forward pass, in w.saved[0]; w.saved[1] is free.
class ByJacobian : public Physics {
 public:
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override;
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override;
  void jacobian(BatchOut J, Workspace& w) const override { J = saved_jacobian(w); }

 protected:
  virtual void form_jacobian(Matrix& J, Workspace& w) const = 0;  // (m, k·B) at w.x, given as zeros

 private:
  const Matrix& saved_jacobian(Workspace& w) const;
};

// Products of one sample by a sparse Jacobian, whose values are computed once a forward pass, in
// w.saved[0].
class BySparseJacobian : public Physics {
 public:
  explicit BySparseJacobian(SparsePattern pattern) : pattern_(std::move(pattern)) {}
  Index inputs() const final { return pattern_.columns; }
  Index outputs() const final { return pattern_.rows(); }
  const SparsePattern* sparse_pattern() const final { return &pattern_; }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override;
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override;
  void jacobian(BatchOut J, Workspace& w) const override;

 private:
  const Real* saved_values(Workspace& w) const;
  SparsePattern pattern_;
};

// y = A x with A = Aᵀ, whose products are the forward pass again.
class SelfAdjointPhysics : public Physics {
 public:
  virtual void apply(BatchRef x, BatchOut y) const = 0;  // A x

  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const final { apply(x, y); }
  void pushforward(BatchRef v, BatchOut Jv, Workspace&) const final { apply(v, Jv); }
  void pullback(BatchRef u, BatchOut JTu, Workspace&) const final { apply(u, JTu); }
  bool has_curvature() const final { return true; }
  void curvature(BatchRef, BatchOut out, Workspace&) const final { out.setZero(); }
  void curvature_product(BatchRef, BatchRef, BatchOut out, Workspace&) const final {
    out.setZero();
  }
};

// Progressively refined physics: Bhatia, Köhler, Thuerey (2025), arXiv 2502.19611. A run starts
// with few iterations of a solve, and adds some where its validation loss no longer falls, unless
// the last addition did not help. Thresholds and the mean are those of the authors' heat_1d.ipynb,
// whose epochs have 8 steps.
struct Refinement {
  Index first = 1, step = 0, most = 1;  // iterations of a solve
  static constexpr std::int64_t kEpoch = 8;

  struct State {
    Index iterations = 0;
    std::int64_t epochs = 0;
    Real means[3] = {};                                  // of the losses, the last one first
    Real level = std::numeric_limits<Real>::infinity();  // the mean at the last addition
  };
  void see(Real validation_loss, State& state) const;  // once an epoch, and at the start
};

// Physics of a learning problem that solves by as many iterations as the context (1, B) says. The
// training follows the refinement, and the validation what its samples say.
class RefinedPhysics : public Physics {
 public:
  explicit RefinedPhysics(const Refinement& refinement) : refinement_(refinement) {}
  const Refinement& refinement() const { return refinement_; }

 private:
  Refinement refinement_;
};

}  // namespace isoline::problems
