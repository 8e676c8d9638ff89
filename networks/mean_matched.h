// placeholder until merged
#pragma once
#include "networks/network.h"
namespace isoline {
class MeanMatched final : public Network {
 public:
  explicit MeanMatched(std::unique_ptr<Network> inner) : inner_(std::move(inner)) {}
  Index parameters() const override { return inner_->parameters(); }
  Index inputs() const override { return inner_->inputs(); }
  Index outputs() const override { return inner_->outputs(); }
  Vector start(RandomStream& s) const override { return inner_->start(s); }
  std::vector<Block> layout() const override { return inner_->layout(); }
  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override { inner_->forward(theta, in, x, w); }
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override { inner_->pushforward(v, Jv, w); }
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override { inner_->pullback(u, JTu, w); }
 private:
  std::unique_ptr<Network> inner_;
};
}
