// A perceptron with value, gradient and Laplacian: forward pass, products, factors of its layers.
#include "networks/laplacian_perceptron.h"

#include <cmath>
#include <sstream>

#include "core/errors.h"
#include "core/product.h"
#include "networks/activation.h"

namespace isoline::networks {
namespace {

class LaplacianPerceptron final : public Network {
 public:
  explicit LaplacianPerceptron(LaplacianShape shape) : shape_(std::move(shape)) {}

  Index parameters() const override { return offset(layers()) + constants(); }
  Index inputs() const override { return dimension() + 1; }
  Index outputs() const override { return 1 + derivatives() + constants(); }
  bool has_layer_factors() const override { return true; }
  std::vector<Block> layout() const override {
    std::vector<Block> blocks;
    for (Index l = 0; l < layers(); ++l) {
      blocks.push_back({offset(l), width(l + 1), width(l), Block::Kind::weight});
      blocks.push_back({bias(l), width(l + 1), 1, Block::Kind::bias});
    }
    if (constants() > 0) {  // the biases of a layer without inputs
      blocks.push_back({offset(layers()), constants(), 0, Block::Kind::weight});
      blocks.push_back({offset(layers()), constants(), 1, Block::Kind::bias});
    }
    return blocks;
  }
  Vector start(RandomStream& stream) const override {
    Vector theta(parameters());
    theta.tail(constants()) = shape_.constants;
    const Index weights = offset(layers());
    if (shape_.deviation > 0)
      theta.head(weights) = shape_.deviation * stream.normal_vector(weights);
    for (Index l = 0; l < layers() && shape_.deviation == 0; ++l) {
      const Real bound = 1 / std::sqrt(static_cast<Real>(width(l)));
      const Index count = offset(l + 1) - offset(l);
      theta.segment(offset(l), count) = stream.uniform_vector(count, -bound, bound);
    }
    return theta;
  }

  void forward(VectorRef theta, BatchRef in, BatchOut x, Workspace& w) const override {
    Passes& own = sized(w, in);
    own.theta = theta;
    own.layers[0].a.leftCols(in.cols()) = in.topRows(dimension());
    for (Index l = 0; l < layers(); ++l) {
      Layer* at = &own.layers[static_cast<std::size_t>(l)];
      product(Form::A_B, weights(own.theta, l), at->a, at->z);
      at->z.leftCols(in.cols()).colwise() += own.theta.segment(bias(l), width(l + 1));
      if (l + 1 < layers()) activate(own, *at, at[1].a);
    }
    read(own, own.layers.back().z, theta, x);
  }
  void pushforward(VectorRef v, BatchOut Jv, Workspace& w) const override {
    auto& own = w.as<Passes>();
    for (Index l = 0; l < layers(); ++l) {
      Layer* at = &own.layers[static_cast<std::size_t>(l)];
      product(Form::A_B, weights(v, l), at->a, at->dz);
      at->dz.leftCols(Jv.cols()).colwise() += v.segment(bias(l), width(l + 1));
      if (l > 0) product(Form::A_B, weights(own.theta, l), at->da, at->dz, 1);
      if (l + 1 < layers()) push(own, *at, at[1].da);
    }
    read(own, own.layers.back().dz, v, Jv);
  }
  // ∂W = Σ over lanes of g aᵀ, ∂b = Σ over values of g
  void pullback(BatchRef u, VectorOut JTu, Workspace& w) const override {
    auto& own = w.as<Passes>();
    backward(u, own);
    for (Index l = 0; l < layers(); ++l) {
      const Layer& at = own.layers[static_cast<std::size_t>(l)];
      product(Form::A_BH, at.g, at.a,
              Eigen::Map<Matrix>(JTu.data() + offset(l), width(l + 1), width(l)));
      JTu.segment(bias(l), width(l + 1)) = at.g.leftCols(u.cols()).rowwise().sum();
    }
    JTu.tail(constants()) = u.bottomRows(constants()).rowwise().sum();
  }
  // All rows i of the samples at once: samples do not depend on each other.
  void jacobian(BatchRef dy_dx, BatchOut J, Workspace& w) const override {
    auto& own = w.as<Passes>();
    const Index m = dy_dx.rows(), samples = own.samples;
    Matrix u(outputs(), samples), rows;
    for (Index i = 0; i < m; ++i) {
      u = dy_dx.row(i).reshaped(outputs(), samples);
      backward(u, own);
      for (Index l = 0; l < layers(); ++l) {
        const Layer& at = own.layers[static_cast<std::size_t>(l)];
        const Index count = width(l + 1) * width(l), first = offset(l);
        rows.resize(count, samples);  // of W, transposed
        for (Index b = 0; b < samples; ++b)
          rows.col(b).reshaped(width(l + 1), width(l)).noalias() =
              at.g.col(b) * at.a.col(b).transpose();
        for (std::size_t j = 0; j < own.inside.size(); ++j)
          product(Form::A_BH, lanes(at.g, own, j), lanes(at.a, own, j),
                  rows.col(own.inside[j]).reshaped(width(l + 1), width(l)), 1);
        for (Index b = 0; b < samples; ++b) {
          J.row(b * m + i).segment(first, count) = rows.col(b);
          J.row(b * m + i).segment(bias(l), width(l + 1)) = at.g.col(b);
        }
      }
      for (Index b = 0; b < samples; ++b)
        J.row(b * m + i).tail(constants()) = u.col(b).tail(constants());
    }
  }
  void layer_factors(BatchRef u, std::vector<LayerFactor>& out, Workspace& w) const override {
    auto& own = w.as<Passes>();
    backward(u, own);
    out.resize(own.layers.size() + (constants() > 0 ? 1 : 0));
    for (Index l = 0; l < layers(); ++l) {
      const Layer& at = own.layers[static_cast<std::size_t>(l)];
      LayerFactor& factor = out[static_cast<std::size_t>(l)];
      factor.weight = 2 * l;
      factor.bias = 2 * l + 1;
      spread(own, at.a, factor.inputs);
      spread(own, at.g, factor.cotangents);
    }
    if (constants() == 0) return;
    LayerFactor& last = out.back();
    last.weight = 2 * layers();
    last.bias = last.weight + 1;
    last.inputs.resize(0, out[0].inputs.cols());
    last.cotangents.setZero(constants(), out[0].inputs.cols());
    last.cotangents.leftCols(u.cols()) = u.bottomRows(constants());
  }

 private:
  // The columns of all arrays are the values of all samples first, then for each sample inside its
  // gradient and Laplacian, C columns in all.
  struct Layer {
    Matrix a, z, g;     // (w_{l−1}, C), (w_l, C), and the cotangent of z
    Matrix da, dz;      // their change along the last v
    Matrix s1, s2, s3;  // s', s'', s''' at the values, (w_l, B)
    Matrix squares;     // Σ (∂ᵢz)², (w_l, samples inside)
  };
  struct Passes final : Scratch {
    Index samples = -1;                // B
    std::vector<Index> inside, found;  // the samples in Ω, and those of the next forward pass
    Vector theta;
    std::vector<Layer> layers;
    Vector room;  // of one column
  };

  Index dimension() const { return shape_.widths.front(); }
  Index constants() const { return shape_.constants.size(); }
  Index derivatives() const {
    return shape_.shows_gradient ? dimension() + 1 : 1;
  }  // that are shown
  Index layers() const { return static_cast<Index>(shape_.widths.size()) - 1; }
  Index width(Index l) const { return shape_.widths[static_cast<std::size_t>(l)]; }
  Index offset(Index layer) const {  // of W in θ
    Index sum = 0;
    for (Index l = 0; l < layer; ++l) sum += width(l + 1) * (width(l) + 1);
    return sum;
  }
  Index bias(Index l) const { return offset(l) + width(l + 1) * width(l); }
  Eigen::Map<const Matrix> weights(VectorRef theta, Index l) const {
    return {theta.data() + offset(l), width(l + 1), width(l)};
  }
  // Gradient and Laplacian of the j-th sample with derivatives, said to be inside, (·, d + 1).
  template <class Array>
  Eigen::Block<Array, Eigen::Dynamic, Eigen::Dynamic, true> lanes(Array& array, const Passes& own,
                                                                  std::size_t j) const {
    const Index count = dimension() + 1;
    return array.middleCols(own.samples + static_cast<Index>(j) * count, count);
  }

  Passes& sized(Workspace& w, BatchRef in) const {
    auto& own = w.as<Passes>();
    own.found.clear();
    for (Index b = 0; b < in.cols(); ++b)
      if (in(dimension(), b) != 0) own.found.push_back(b);
    if (own.samples == in.cols() && own.inside == own.found) return own;
    own.samples = in.cols();
    own.inside = own.found;
    own.layers.resize(shape_.widths.size() - 1);
    const auto count = static_cast<Index>(own.inside.size());
    const Index columns = own.samples + count * (dimension() + 1);
    for (Index l = 0; l < layers(); ++l) {
      Layer& at = own.layers[static_cast<std::size_t>(l)];
      for (Matrix* array : {&at.a, &at.da}) array->setZero(width(l), columns);
      for (Matrix* array : {&at.z, &at.dz, &at.g}) array->setZero(width(l + 1), columns);
      for (Matrix* array : {&at.s1, &at.s2, &at.s3}) array->setZero(width(l + 1), own.samples);
      at.squares.setZero(width(l + 1), count);
    }
    Matrix& points = own.layers[0].a;  // ∂ᵢp = eᵢ and Δp = 0
    for (std::size_t j = 0; j < own.inside.size(); ++j)
      lanes(points, own, j).leftCols(dimension()).setIdentity();
    return own;
  }
  void read(const Passes& own, const Matrix& z, VectorRef theta, BatchOut x) const {
    const Index shown = derivatives();
    x.row(0) = z.leftCols(own.samples);
    x.middleRows(1, shown).setZero();
    for (std::size_t j = 0; j < own.inside.size(); ++j)
      x.col(own.inside[j]).segment(1, shown) = lanes(z, own, j).row(0).tail(shown).transpose();
    x.bottomRows(constants()).colwise() = theta.tail(constants());
  }

  void activate(Passes& own, Layer& at, Matrix& a) const {
    const Index B = own.samples, d = dimension(), size = at.s1.size();
    const auto flat = [size](Matrix& array) {
      return Eigen::Map<Flat<Real>, Eigen::AlignedMax>(array.data(), size);
    };
    networks::activate<Real>(Activation::tanh, flat(at.z), flat(a));
    const auto t = a.leftCols(B).array();
    at.s1 = 1 - t.square();
    at.s2 = -2 * t * at.s1.array();
    at.s3 = at.s1.array() * (6 * t.square() - 2);
    for (std::size_t j = 0; j < own.inside.size(); ++j) {
      const Index b = own.inside[j];
      const auto s1 = at.s1.col(b).array(), s2 = at.s2.col(b).array();
      const auto z = lanes(at.z, own, j);
      auto out = lanes(a, own, j);
      auto squares = at.squares.col(static_cast<Index>(j));
      squares = z.leftCols(shape_.curved).rowwise().squaredNorm();
      out = (z.array().colwise() * s1).matrix();
      out.col(d).array() += s2 * squares.array();
    }
  }
  // ȧ = s' ż,  (∂ᵢa)˙ = s' ∂ᵢż + s'' ż ∂ᵢz,
  // (Δa)˙ = s' Δż + s'' (ż Δz + 2 Σ ∂ᵢz ∂ᵢż) + s''' ż Σ (∂ᵢz)²
  void push(Passes& own, const Layer& at, Matrix& da) const {
    const Index B = own.samples, d = dimension(), s = shape_.curved;
    da.leftCols(B) = at.s1.cwiseProduct(at.dz.leftCols(B));
    for (std::size_t j = 0; j < own.inside.size(); ++j) {
      const Index b = own.inside[j];
      const auto s1 = at.s1.col(b).array(), s2 = at.s2.col(b).array(), s3 = at.s3.col(b).array();
      const auto z = lanes(at.z, own, j), dz = lanes(at.dz, own, j);
      const auto change = at.dz.col(b).array();
      auto out = lanes(da, own, j);
      own.room = (s2 * change).matrix();
      out = (dz.array().colwise() * s1 + z.array().colwise() * own.room.array()).matrix();
      own.room = z.leftCols(s).cwiseProduct(dz.leftCols(s)).rowwise().sum();
      out.col(d).array() +=
          2 * s2 * own.room.array() + s3 * change * at.squares.col(static_cast<Index>(j)).array();
    }
  }
  // g_L = u, and below, with h = W_lᵀ g_l,
  //   g_Δ = s' h_Δ,  gᵢ = s' hᵢ + 2 s'' ∂ᵢz h_Δ,
  //   g = s' h + s'' (Σ ∂ᵢz hᵢ + Δz h_Δ) + s''' Σ (∂ᵢz)² h_Δ
  void backward(BatchRef u, Passes& own) const {
    const Index B = own.samples, d = dimension(), s = shape_.curved;
    Matrix& top = own.layers.back().g;
    top.leftCols(B) = u.row(0);
    for (std::size_t j = 0; j < own.inside.size(); ++j) {
      lanes(top, own, j).setZero();
      lanes(top, own, j).row(0).tail(derivatives()) =
          u.col(own.inside[j]).segment(1, derivatives()).transpose();
    }
    for (Index l = layers() - 1; l > 0; --l) {
      Layer& at = own.layers[static_cast<std::size_t>(l - 1)];
      product(Form::AH_B, weights(own.theta, l), own.layers[static_cast<std::size_t>(l)].g, at.g);
      at.g.leftCols(B).array() *= at.s1.array();
      for (std::size_t j = 0; j < own.inside.size(); ++j) {
        const Index b = own.inside[j];
        const auto s1 = at.s1.col(b).array(), s2 = at.s2.col(b).array(), s3 = at.s3.col(b).array();
        const auto z = lanes(at.z, own, j);
        auto h = lanes(at.g, own, j);
        own.room = z.cwiseProduct(h).rowwise().sum();
        at.g.col(b).array() +=
            s2 * own.room.array() +
            s3 * at.squares.col(static_cast<Index>(j)).array() * h.col(d).array();
        own.room = (2 * s2 * h.col(d).array()).matrix();
        h = (h.array().colwise() * s1).matrix();
        h.leftCols(s).array() += z.leftCols(s).array().colwise() * own.room.array();
      }
    }
  }
  // The lanes one after the other, each with a column for every sample: zeros on the boundary.
  void spread(const Passes& own, const Matrix& from, Matrix& to) const {
    const Index B = own.samples;
    to.setZero(from.rows(), B * (dimension() + 2));
    to.leftCols(B) = from.leftCols(B);
    for (std::size_t j = 0; j < own.inside.size(); ++j)
      for (Index i = 0; i <= dimension(); ++i)
        to.col((i + 1) * B + own.inside[j]) = lanes(from, own, j).col(i);
  }

  LaplacianShape shape_;
};

}  // namespace

std::vector<Index> perceptron_widths(const std::string& of, Index dimension,
                                     const std::string& layers) {
  constexpr std::size_t kDigits = 4;
  std::vector<Index> widths{dimension};
  std::istringstream text(layers + '-');
  for (std::string width; std::getline(text, width, '-');) {
    const bool is_whole = width.find_first_not_of("0123456789") == std::string::npos;
    require(is_whole && !width.empty() && width.size() <= kDigits && width[0] != '0', [&] {
      return of + ": layers must be widths from 1 to 9999 joined by '-', as in 64-48-32";
    });
    widths.push_back(std::stoi(width));
  }
  widths.push_back(1);
  return widths;
}

std::unique_ptr<Network> laplacian_perceptron(LaplacianShape shape) {
  return std::make_unique<LaplacianPerceptron>(std::move(shape));
}

}  // namespace isoline::networks
