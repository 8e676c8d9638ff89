// The Jacobian J of a network of dense layers, (m·B, n), by the factors of its layers and never
// formed: with A the inputs of a layer, a 1 below each for the bias, and G = ∂y/∂z its
// sensitivities, one row for each number of y, a row of J is for each layer the outer product of a
// row of G with the input of its sample, or the sum of those of all lanes of its sample.
#pragma once

#include <algorithm>
#include <vector>

#include "core/archive.h"
#include "core/product.h"
#include "optimizers/meter.h"

namespace isoline::optimizers {

class LayeredJacobian {
 public:
  // m pullbacks that keep what passes
  void take(Linearization& at) {
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
        layers_[l].G.resize(cotangents.rows(), m_ * cotangents.cols());
        for (Index c = 0; c < cotangents.cols(); ++c)
          layers_[l].G.col(c * m_ + i) = cotangents.col(c);
      }
    }
    for (std::size_t l = 0; l < factors_.size(); ++l) {
      const Matrix& inputs = factors_[l].inputs;
      layers_[l].A.setZero(inputs.rows() + 1, inputs.cols());
      layers_[l].A.topRows(inputs.rows()) = inputs;
      layers_[l].A.bottomRows<1>().head(samples_).setOnes();
      layers_[l].weight = factors_[l].weight;
      layers_[l].bias = factors_[l].bias;
    }
  }
  Index rows() const { return m_ * samples_; }  // m·B
  // The lower half of K = JJᵀ = Σ_layers (G Gᵀ) ∘ (Aᵀ A ⊗ 1), (m·B, m·B).
  void gram(Matrix& K) {
    K.setZero(rows(), rows());
    likeness_.resize(samples_, samples_);
    GG_.resize(rows(), rows());
    for (const Layer& layer : layers_) {
      const Matrix &A = layer.A, &G = layer.G;
      if (lanes() > 1) {
        for_rows(layer, [&](Index, const Matrix& rows) {
          lower_gram(rows, GG_);
          K += GG_;
        });
        continue;
      }
      product(Form::AH_B, A, A, likeness_);
      lower_gram(G, GG_);
      for (Index column = 0; column < rows(); ++column) {
        const Index of = column / m_;  // the sample
        for (Index b = of; b < samples_; ++b)
          K.col(column).segment(b * m_, m_) +=
              likeness_(b, of) * GG_.col(column).segment(b * m_, m_);
      }
    }
  }
  // The same of J diag(w) Jᵀ, w (n) in the order of its own.
  // Sample by sample t, with all from t on: Σ_o G_oa G_ob c_o, c = Σᵢ w_oᵢ A_is A_it.
  void weighted_gram(const Vector& w, Matrix& K) {
    K.setZero(rows(), rows());
    Index offset = 0;
    for (const Layer& layer : layers_) {
      const Matrix &A = layer.A, &G = layer.G;
      const auto W = w.segment(offset, layer.parameters()).reshaped(G.rows(), A.rows());
      if (lanes() > 1) {
        for_rows(layer, [&](Index first, const Matrix& rows) {
          weighed_ = rows.array().colwise() * w.segment(offset + first, rows.rows()).array();
          product(Form::AH_B, weighed_, rows, K, 1);
        });
        offset += layer.parameters();
        continue;
      }
      for (Index t = 0; t < samples_; ++t) {
        const Index count = samples_ - t, first = t * m_;
        pairs_ = A.rightCols(count).array().colwise() * A.col(t).array();
        shares_.resize(G.rows(), count);
        product(Form::A_B, W, pairs_, shares_);
        weighed_.resize(G.rows(), count * m_);
        for (Index s = 0; s < count; ++s)
          weighed_.middleCols(s * m_, m_) =
              G.middleCols(first + s * m_, m_).array().colwise() * shares_.col(s).array();
        product(Form::AH_B, weighed_, G.middleCols(first, m_),
                K.block(first, first, count * m_, m_), 1);
      }
      offset += layer.parameters();
    }
  }
  // The squared norms of J's columns, (n) in the order of its own.
  void squared_columns(Vector& out) {
    out.resize(parameters());
    Index offset = 0;
    for (const Layer& layer : layers_) {
      const Matrix &A = layer.A, &G = layer.G;
      if (lanes() > 1) {
        for_rows(layer, [&](Index first, const Matrix& rows) {
          out.segment(offset + first, rows.rows()) = rows.rowwise().squaredNorm();
        });
        offset += layer.parameters();
        continue;
      }
      shares_.resize(G.rows(), samples_);
      for (Index b = 0; b < samples_; ++b)
        shares_.col(b) = G.middleCols(b * m_, m_).rowwise().squaredNorm();
      pairs_ = A.cwiseAbs2();
      product(Form::A_BH, shares_, pairs_,
              out.segment(offset, layer.parameters()).reshaped(G.rows(), A.rows()));
      offset += layer.parameters();
    }
  }
  // Z = Jᵀ Y and Y = J Z for columns Y (m·B, p) and Z (n, p), the parameters in an order of its
  // own: layer by layer, the bias last.
  void pullback(const Matrix& Y, Matrix& Z) {
    Index offset = 0;
    Z.resize(parameters(), Y.cols());
    for (const Layer& layer : layers_) {
      const Matrix &A = layer.A, &G = layer.G;
      const Index outputs = G.rows();
      for (Index first = 0; first < Y.cols(); first += kTogether) {
        const Index p = std::min(kTogether, Y.cols() - first);
        cotangents_.resize(outputs * p, A.cols());
        for (Index c = 0; c < A.cols(); ++c)
          product(Form::A_B, G.middleCols(c * m_, m_), Y.block(c % samples_ * m_, first, m_, p),
                  cotangents_.col(c).reshaped(outputs, p));
        outer_.resize(outputs * p, A.rows());
        product(Form::A_BH, cotangents_, A, outer_);
        for (Index j = 0; j < p; ++j)
          Z.col(first + j).segment(offset, layer.parameters()).reshaped(outputs, A.rows()) =
              outer_.middleRows(j * outputs, outputs);
      }
      offset += layer.parameters();
    }
  }
  void pushforward(const Matrix& Z, Matrix& Y) {
    Index offset = 0;
    Y.setZero(m_ * samples_, Z.cols());
    for (const Layer& layer : layers_) {
      const Matrix &A = layer.A, &G = layer.G;
      const Index outputs = G.rows();
      for (Index first = 0; first < Z.cols(); first += kTogether) {
        const Index p = std::min(kTogether, Z.cols() - first);
        outer_.resize(outputs * p, A.rows());
        for (Index j = 0; j < p; ++j)
          outer_.middleRows(j * outputs, outputs) =
              Z.col(first + j).segment(offset, layer.parameters()).reshaped(outputs, A.rows());
        cotangents_.resize(outputs * p, A.cols());
        product(Form::A_B, outer_, A, cotangents_);
        for (Index c = 0; c < A.cols(); ++c)
          product(Form::AH_B, G.middleCols(c * m_, m_), cotangents_.col(c).reshaped(outputs, p),
                  Y.block(c % samples_ * m_, first, m_, p), 1);
      }
      offset += layer.parameters();
    }
  }
  // Where in θ each parameter of that order stands.
  void order(const std::vector<Block>& layout, Eigen::Matrix<Index, Eigen::Dynamic, 1>& out) const {
    Index next = 0;
    out.resize(parameters());
    for (const Layer& layer : layers_)
      for (const Block& block : {layout[layer.weight], layout[layer.bias]})
        for (Index i = 0; i < block.rows * block.columns; ++i) out[next++] = block.offset + i;
  }
  void persist(Archive& archive) {
    std::size_t count = layers_.size();
    archive(m_, samples_, count);
    layers_.resize(count);
    for (Layer& layer : layers_) archive(layer.A, layer.G, layer.weight, layer.bias);
  }

 private:
  // Columns at once, so that what is between two products stays in the cache.
  static constexpr Index kTogether = 16;

  // n
  Index parameters() const {
    Index sum = 0;
    for (const Layer& layer : layers_) sum += layer.parameters();
    return sum;
  }
  struct Layer {
    Matrix A, G;         // (inputs + 1, lanes·B), and transposed, (outputs, m·lanes·B)
    Index weight, bias;  // in the layout

    Index parameters() const { return A.rows() * G.rows(); }
  };

  Index lanes() const { return layers_.front().A.cols() / samples_; }
  // The rows of J in this layer for some of its inputs at a time, so that a block stays in the
  // cache: use(first, rows), rows (parameters of the block, m·B) from the parameter `first` on.
  template <class Use>
  void for_rows(const Layer& layer, const Use& use) {
    using Lanes = Eigen::Map<const Matrix, Eigen::Unaligned, Eigen::OuterStride<>>;
    const Matrix &A = layer.A, &G = layer.G;
    const Index outputs = G.rows();
    for (Index first = 0; first < A.rows(); first += kTogether) {
      const Index inputs = std::min(kTogether, A.rows() - first);
      rows_.resize(outputs * inputs, rows());
      for (Index row = 0; row < rows(); ++row)
        product(
            Form::A_BH, Lanes(&G(0, row), outputs, lanes(), Eigen::OuterStride<>(outputs * rows())),
            Lanes(&A(first, row / m_), inputs, lanes(), Eigen::OuterStride<>(A.rows() * samples_)),
            rows_.col(row).reshaped(outputs, inputs));
      use(first * outputs, rows_);
    }
  }

  std::vector<Layer> layers_;
  std::vector<LayerFactor> factors_;
  Index m_ = 0, samples_ = 0;
  Matrix unit_, likeness_, GG_;      // (m, B), Aᵀ A (B, B), G Gᵀ (m·B, m·B)
  Matrix shares_, pairs_, weighed_;  // of one sample with others: Σ w a a, a a, G by those
  Matrix cotangents_,
      outer_;    // of a few columns: (outputs · p, lanes·B), (outputs · p, inputs + 1)
  Matrix rows_;  // of a few inputs: (outputs · inputs, m·B)
};

}  // namespace isoline::optimizers
