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
  }
}

void LayeredJacobian::gram(Matrix& K) {
  const Index rows = m_ * samples_;
  K.setZero(rows, rows);
  likeness_.resize(samples_, samples_);
  GG_.resize(rows, rows);
  for (const auto& [A, G] : layers_) {
    product(Form::AH_B, A, A, likeness_);
    lower_gram(G, GG_);
    for (Index column = 0; column < rows; ++column) {
      const Index of = column / m_;  // the sample
      for (Index b = of; b < samples_; ++b)
        K.col(column).segment(b * m_, m_) += likeness_(b, of) * GG_.col(column).segment(b * m_, m_);
    }
  }
}

void LayeredJacobian::pullback(const Matrix& Y, Matrix& Z) {
  Index size = 0, offset = 0;
  for (const Layer& layer : layers_) size += layer.parameters();
  Z.resize(size, Y.cols());
  for (const Layer& layer : layers_) {
    const auto& [A, G] = layer;
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
    const auto& [A, G] = layer;
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
