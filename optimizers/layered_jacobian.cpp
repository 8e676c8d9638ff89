// The Gram matrix and the products of a network's Jacobian from the factors of its layers.
#include "optimizers/layered_jacobian.h"

#include <algorithm>

#include "core/product.h"

namespace isoline::optimizers {
namespace {

constexpr Index kColumns = 16;  // at once, so that what is between two products stays in the cache

}  // namespace

void LayeredJacobian::take(Linearization& at) {
  m_ = at.y().rows();
  samples_ = at.y().cols();
  unit_.setZero(m_, samples_);
  for (Index i = 0; i < m_; ++i) {
    unit_.row(i).setOnes();
    at.layer_factors(unit_, factors_);
    unit_.row(i).setZero();
    layers_.resize(factors_.size());
    for (std::size_t l = 0; l < factors_.size(); ++l) {
      const Matrix& cotangents = factors_[l].cotangents;
      layers_[l].G.resize(cotangents.rows(), m_ * samples_);
      for (Index b = 0; b < samples_; ++b) layers_[l].G.col(b * m_ + i) = cotangents.col(b);
    }
  }
  for (std::size_t l = 0; l < factors_.size(); ++l) {
    const Matrix& inputs = factors_[l].inputs;
    layers_[l].A.resize(inputs.rows() + 1, samples_);
    layers_[l].A.topRows(inputs.rows()) = inputs;
    layers_[l].A.bottomRows<1>().setOnes();
    layers_[l].weight = factors_[l].weight;
    layers_[l].bias = factors_[l].bias;
  }
}

void LayeredJacobian::gram(Matrix& K) {
  K.setZero(rows(), rows());
  likeness_.resize(samples_, samples_);
  GG_.resize(rows(), rows());
  for (const Layer& layer : layers_) {
    const Matrix &A = layer.A, &G = layer.G;
    product(Form::AH_B, A, A, likeness_);
    lower_gram(G, GG_);
    for (Index column = 0; column < rows(); ++column) {
      const Index of = column / m_;  // the sample
      for (Index b = of; b < samples_; ++b)
        K.col(column).segment(b * m_, m_) += likeness_(b, of) * GG_.col(column).segment(b * m_, m_);
    }
  }
}

// Sample by sample t, with all from t on: Σ_o G_oa G_ob c_o, c = Σᵢ w_oᵢ A_is A_it.
void LayeredJacobian::weighted_gram(const Vector& w, Matrix& K) {
  K.setZero(rows(), rows());
  Index offset = 0;
  for (const Layer& layer : layers_) {
    const Matrix &A = layer.A, &G = layer.G;
    const auto W = w.segment(offset, layer.parameters()).reshaped(G.rows(), A.rows());
    for (Index t = 0; t < samples_; ++t) {
      const Index count = samples_ - t, first = t * m_;
      pairs_ = A.rightCols(count).array().colwise() * A.col(t).array();
      shares_.resize(G.rows(), count);
      product(Form::A_B, W, pairs_, shares_);
      weighed_.resize(G.rows(), count * m_);
      for (Index s = 0; s < count; ++s)
        weighed_.middleCols(s * m_, m_) =
            G.middleCols(first + s * m_, m_).array().colwise() * shares_.col(s).array();
      product(Form::AH_B, weighed_, G.middleCols(first, m_), K.block(first, first, count * m_, m_),
              1);
    }
    offset += layer.parameters();
  }
}

void LayeredJacobian::squared_columns(Vector& out) {
  Index size = 0;
  for (const Layer& layer : layers_) size += layer.parameters();
  out.resize(size);
  Index offset = 0;
  for (const Layer& layer : layers_) {
    const Matrix &A = layer.A, &G = layer.G;
    shares_.resize(G.rows(), samples_);
    for (Index b = 0; b < samples_; ++b)
      shares_.col(b) = G.middleCols(b * m_, m_).rowwise().squaredNorm();
    pairs_ = A.cwiseAbs2();
    product(Form::A_BH, shares_, pairs_,
            out.segment(offset, layer.parameters()).reshaped(G.rows(), A.rows()));
    offset += layer.parameters();
  }
}

void LayeredJacobian::order(const std::vector<Block>& layout,
                            Eigen::Matrix<Index, Eigen::Dynamic, 1>& out) const {
  Index size = 0, next = 0;
  for (const Layer& layer : layers_) size += layer.parameters();
  out.resize(size);
  for (const Layer& layer : layers_)
    for (const Block& block : {layout[layer.weight], layout[layer.bias]})
      for (Index i = 0; i < block.rows * block.columns; ++i) out[next++] = block.offset + i;
}

void LayeredJacobian::persist(Archive& archive) {
  std::size_t count = layers_.size();
  archive(m_, samples_, count);
  layers_.resize(count);
  for (Layer& layer : layers_) archive(layer.A, layer.G, layer.weight, layer.bias);
}

void LayeredJacobian::pullback(const Matrix& Y, Matrix& Z) {
  Index size = 0, offset = 0;
  for (const Layer& layer : layers_) size += layer.parameters();
  Z.resize(size, Y.cols());
  for (const Layer& layer : layers_) {
    const Matrix &A = layer.A, &G = layer.G;
    const Index outputs = G.rows();
    for (Index first = 0; first < Y.cols(); first += kColumns) {
      const Index p = std::min(kColumns, Y.cols() - first);
      cotangents_.resize(outputs * p, samples_);
      for (Index b = 0; b < samples_; ++b)
        product(Form::A_B, G.middleCols(b * m_, m_), Y.block(b * m_, first, m_, p),
                cotangents_.col(b).reshaped(outputs, p));
      outer_.resize(outputs * p, A.rows());
      product(Form::A_BH, cotangents_, A, outer_);
      for (Index j = 0; j < p; ++j)
        Z.col(first + j).segment(offset, layer.parameters()).reshaped(outputs, A.rows()) =
            outer_.middleRows(j * outputs, outputs);
    }
    offset += layer.parameters();
  }
}

void LayeredJacobian::pushforward(const Matrix& Z, Matrix& Y) {
  Index offset = 0;
  Y.setZero(m_ * samples_, Z.cols());
  for (const Layer& layer : layers_) {
    const Matrix &A = layer.A, &G = layer.G;
    const Index outputs = G.rows();
    for (Index first = 0; first < Z.cols(); first += kColumns) {
      const Index p = std::min(kColumns, Z.cols() - first);
      outer_.resize(outputs * p, A.rows());
      for (Index j = 0; j < p; ++j)
        outer_.middleRows(j * outputs, outputs) =
            Z.col(first + j).segment(offset, layer.parameters()).reshaped(outputs, A.rows());
      cotangents_.resize(outputs * p, samples_);
      product(Form::A_B, outer_, A, cotangents_);
      for (Index b = 0; b < samples_; ++b)
        product(Form::AH_B, G.middleCols(b * m_, m_), cotangents_.col(b).reshaped(outputs, p),
                Y.block(b * m_, first, m_, p), 1);
    }
    offset += layer.parameters();
  }
}

}  // namespace isoline::optimizers
