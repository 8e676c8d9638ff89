// The identity network x = θ: with it a learning problem is the direct optimization of one x.
#pragma once

#include "networks/network.h"

namespace isoline::networks {

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
