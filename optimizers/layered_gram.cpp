// The Gram matrix of a network's Jacobian from the factors of its layers.
#include "optimizers/layered_gram.h"

#include "core/product.h"

namespace isoline::optimizers {

void LayeredGram::form(Linearization& at, Matrix& K) {
  const Index m = at.y().rows(), samples = at.y().cols();
  unit_.setZero(m, samples);
  for (Index i = 0; i < m; ++i) {
    unit_.row(i).setOnes();
    at.layer_factors(unit_, factors_);
    unit_.row(i).setZero();
    G_.resize(factors_.size());
    for (std::size_t l = 0; l < factors_.size(); ++l) {
      const Matrix& cotangents = factors_[l].cotangents;
      G_[l].resize(cotangents.rows(), m * samples);
      for (Index b = 0; b < samples; ++b) G_[l].col(b * m + i) = cotangents.col(b);
    }
  }
  K.setZero(m * samples, m * samples);
  for (std::size_t l = 0; l < factors_.size(); ++l) add_layer(factors_[l], G_[l], K);
}

void LayeredGram::add_layer(const LayerFactor& factor, const Matrix& G, Matrix& K) {
  const Index samples = factor.inputs.cols(), m = G.cols() / samples;
  likeness_.resize(samples, samples);
  product(Form::AH_B, factor.inputs, factor.inputs, likeness_);
  likeness_.array() += 1;
  GG_.resize(G.cols(), G.cols());
  product(Form::AH_B, G, G, GG_);
  for (Index column = 0; column < K.cols(); ++column) {
    const Index of = column / m;  // the sample
    for (Index b = of; b < samples; ++b)
      K.col(column).segment(b * m, m) += likeness_(b, of) * GG_.col(column).segment(b * m, m);
  }
}

}  // namespace isoline::optimizers
