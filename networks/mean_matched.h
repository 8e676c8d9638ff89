// A network whose output has the mean of its input, sample by sample, as heat conserves it:
//   x = N(in) + mean(in) − mean(N(in))
// Holl, Koltun, Thuerey (2022): the correction after the network of the heat experiment. With the
// projection C = I − 1 1ᵀ/k, all products are those of N with C before or after it.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <utility>

#include "core/workspace.h"
#include "networks/network.h"

namespace isoline::networks {

class MeanMatched final : public Network {
 public:
  explicit MeanMatched(std::unique_ptr<Network> network) : network_(std::move(network)) {
    require(network_->inputs() == network_->outputs(),
            "a network that keeps the mean of its input must have as many outputs as inputs");
  }
  Index parameters() const override { return network_->parameters(); }
  Index inputs() const override { return network_->inputs(); }
  Index outputs() const override { return network_->outputs(); }
  Vector start(RandomStream& stream) const override { return network_->start(stream); }
  std::vector<Block> layout() const override { return network_->layout(); }
  bool has_independent_samples() const override { return network_->has_independent_samples(); }
  bool is_single_precision() const override { return network_->is_single_precision(); }
  bool has_kinks() const override { return network_->has_kinks(); }
  bool has_curvature() const override { return network_->has_curvature(); }
  bool has_layer_factors() const override { return network_->has_layer_factors(); }
  bool has_layer_moments() const override { return network_->has_layer_moments(); }

  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    network_->forward(theta, in, x, w.as<Own>().inner);
    match(in, x);
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    network_->pushforward(v, Jv, w.as<Own>().inner);
    for (Index b = 0; b < Jv.cols(); ++b) Jv.col(b).array() -= mean(Jv, b);
  }
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    auto& own = w.as<Own>();
    network_->pullback(centred(u, own.u), JTu, own.inner);
  }
  void curvature(VectorRef v, BatchRef u, BatchRef du, VectorOut out, Workspace& w) const override {
    auto& own = w.as<Own>();
    network_->curvature(v, centred(u, own.u), centred(du, own.du), out, own.inner);
  }
  void jacobian(BatchRef dy_dx, BatchOut J, Workspace& w) const override {
    auto& own = w.as<Own>();
    own.dy_dx = dy_dx;
    for (Index b = 0; b < dy_dx.cols() / outputs(); ++b) {
      BatchOut sample = own.dy_dx.middleCols(b * outputs(), outputs());
      for (Index i = 0; i < sample.rows(); ++i) sample.row(i).array() -= sample.row(i).mean();
    }
    network_->jacobian(own.dy_dx, J, own.inner);
  }
  void layer_factors(BatchRef u, std::vector<LayerFactor>& out, Workspace& w) const override {
    auto& own = w.as<Own>();
    network_->layer_factors(centred(u, own.u), out, own.inner);
  }
  void layer_moments(BatchRef u, std::vector<LayerMoments>& out, VectorOut JTu,
                     Workspace& w) const override {
    auto& own = w.as<Own>();
    network_->layer_moments(centred(u, own.u), out, JTu, own.inner);
  }
  Vector statistics(VectorRef theta, BatchRef in, Workspace& w) const override {
    return network_->statistics(theta, in, w.as<Own>().inner);
  }
  void infer(VectorRef theta, VectorRef statistics, BatchRef in, BatchOut x,
             Workspace& w) const override {
    network_->infer(theta, statistics, in, x, w.as<Own>().inner);
    match(in, x);
  }

 private:
  struct Own final : Scratch, Pieces {
    void add_choices(PieceDigest& digest) override {
      if (auto* pieces = dynamic_cast<Pieces*>(inner.own.get())) pieces->add_choices(digest);
    }

    Workspace inner;
    Matrix u, du;  // (k, B) cotangents behind C
    Matrix dy_dx;  // (m, k·B)
  };

  // In the order in which Eigen sums an aligned column, whatever the address: equal samples have
  // equal bits at every place of a batch.
  static Real mean(BatchRef columns, Index b) {
    const Real* const v = columns.col(b).data();
    const Index k = columns.rows();
    std::array<Real, 8> lanes{};
    Index i = 0;
    for (; i + 8 <= k; i += 8)
      for (std::size_t j = 0; j < 8; ++j) lanes[j] += v[i + static_cast<Index>(j)];
    for (std::size_t j = 0; j < 4; ++j) lanes[j] += lanes[j + 4];
    for (; i + 4 <= k; i += 4)
      for (std::size_t j = 0; j < 4; ++j) lanes[j] += v[i + static_cast<Index>(j)];
    Real sum = (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
    for (; i < k; ++i) sum += v[i];
    return sum / static_cast<Real>(k);
  }
  static void match(BatchRef in, BatchOut x) {
    for (Index b = 0; b < x.cols(); ++b) x.col(b).array() += mean(in, b) - mean(x, b);
  }
  static const Matrix& centred(BatchRef u, Matrix& out) {
    out = u;
    for (Index b = 0; b < out.cols(); ++b) out.col(b).array() -= mean(u, b);
    return out;
  }

  std::unique_ptr<Network> network_;
};

}  // namespace isoline::networks
