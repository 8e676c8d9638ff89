// A network that solves Poisson's equation: physics-informed learning as least squares in θ,
//
//   −Δu = f in Ω = (0, 1)^d,  u = u* on ∂Ω,  u = N(p; θ),
//   L = ½ (1/N_Ω Σ (Δu + f)² + β/N_∂ Σ (u − u*)²),
//
// N a perceptron of hyperbolic tangents in double precision. A sample is a collocation point p: the
// network maps it to x = (u, Δu), and the physics picks one of the two, y = √(B/N_Ω) Δu inside and
// √(βB/N_∂) u on the boundary, B = N_Ω + N_∂. The error in x is ‖u − u*‖/‖u*‖ over the points of
// the validation in Ω. By dimension:
//    2  sin πp₁ sin πp₂, a grid, β = 4: Müller, Zeinhofer (2023), arXiv 2302.13163, section 4.1;
//       their loss has no ½
//    5  Σ cos πpᵢ, 10  p₁p₂ + p₃p₄ + …, new points in each step, β = 1: Guzmán-Cordero, Dangel,
//       Goldshlager, Zeinhofer (2025), arXiv 2505.12149
//
// Δu is propagated forward with u: each point inside carries d + 2 lanes through the layers, value,
// gradient and Laplacian, with z = W a + b, and for the others z = W a without b,
//   a = s(z),  ∂ᵢa = s' ∂ᵢz,  Δa = s' Δz + s'' Σ (∂ᵢz)²,
// and every product with J is one matrix product per layer over all lanes of all points.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <sstream>

#include "core/product.h"
#include "networks/activation.h"
#include "problems/learning.h"

namespace isoline::problems {
namespace {

// θ, (p; 1 inside or 0 on the boundary) ↦ (u; Δu inside or 0 on the boundary), (d + 1, B) -> (2, B)
class LaplacianPerceptron final : public Network {
 public:
  // widths: d, the hidden layers', 1. Weights and biases of the start are N(0, deviation²), or
  // PyTorch's U(±1/√inputs) where that is 0.
  LaplacianPerceptron(std::vector<Index> widths, Real deviation)
      : widths_(std::move(widths)), deviation_(deviation) {}

  Index parameters() const override { return offset(layers()); }
  Index inputs() const override { return dimension() + 1; }
  Index outputs() const override { return 2; }
  bool has_layer_factors() const override { return true; }
  std::vector<Block> layout() const override {
    std::vector<Block> blocks;
    for (Index l = 0; l < layers(); ++l) {
      blocks.push_back({offset(l), width(l + 1), width(l), Block::Kind::weight});
      blocks.push_back({bias(l), width(l + 1), 1, Block::Kind::bias});
    }
    return blocks;
  }
  Vector start(RandomStream& stream) const override {
    if (deviation_ > 0) return deviation_ * stream.normal_vector(parameters());
    Vector theta(parameters());
    for (Index l = 0; l < layers(); ++l) {
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
    read(own, own.layers.back().z, x);
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
    read(own, own.layers.back().dz, Jv);
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
  }
  // All rows i of the samples at once: samples do not depend on each other.
  void jacobian(BatchRef dy_dx, BatchOut J, Workspace& w) const override {
    auto& own = w.as<Passes>();
    const Index m = dy_dx.rows(), samples = own.samples;
    Matrix u(2, samples), rows;
    for (Index i = 0; i < m; ++i) {
      u = dy_dx.row(i).reshaped(2, samples);
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
    }
  }
  void layer_factors(BatchRef u, std::vector<LayerFactor>& out, Workspace& w) const override {
    auto& own = w.as<Passes>();
    backward(u, own);
    out.resize(own.layers.size());
    for (Index l = 0; l < layers(); ++l) {
      const Layer& at = own.layers[static_cast<std::size_t>(l)];
      LayerFactor& factor = out[static_cast<std::size_t>(l)];
      factor.weight = 2 * l;
      factor.bias = 2 * l + 1;
      spread(own, at.a, factor.inputs);
      spread(own, at.g, factor.cotangents);
    }
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

  Index dimension() const { return widths_.front(); }
  Index layers() const { return static_cast<Index>(widths_.size()) - 1; }
  Index width(Index l) const { return widths_[static_cast<std::size_t>(l)]; }
  Index offset(Index layer) const {  // of W in θ
    Index sum = 0;
    for (Index l = 0; l < layer; ++l) sum += width(l + 1) * (width(l) + 1);
    return sum;
  }
  Index bias(Index l) const { return offset(l) + width(l + 1) * width(l); }
  Eigen::Map<const Matrix> weights(VectorRef theta, Index l) const {
    return {theta.data() + offset(l), width(l + 1), width(l)};
  }
  // Gradient and Laplacian of the j-th sample inside, (·, d + 1).
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
    own.layers.resize(widths_.size() - 1);
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
  void read(const Passes& own, const Matrix& z, BatchOut x) const {
    x.row(0) = z.leftCols(own.samples);
    x.row(1).setZero();
    for (std::size_t j = 0; j < own.inside.size(); ++j)
      x(1, own.inside[j]) = lanes(z, own, j)(0, dimension());
  }

  void activate(Passes& own, Layer& at, Matrix& a) const {
    const Index B = own.samples, d = dimension(), size = at.s1.size();
    using networks::Flat;
    const auto flat = [size](Matrix& array) {
      return Eigen::Map<Flat<Real>, Eigen::AlignedMax>(array.data(), size);
    };
    networks::activate<Real>(networks::Activation::tanh, flat(at.z), flat(a));
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
      squares = z.leftCols(d).rowwise().squaredNorm();
      out = (z.array().colwise() * s1).matrix();
      out.col(d).array() += s2 * squares.array();
    }
  }
  // ȧ = s' ż,  (∂ᵢa)˙ = s' ∂ᵢż + s'' ż ∂ᵢz,
  // (Δa)˙ = s' Δż + s'' (ż Δz + 2 Σ ∂ᵢz ∂ᵢż) + s''' ż Σ (∂ᵢz)²
  void push(Passes& own, const Layer& at, Matrix& da) const {
    const Index B = own.samples, d = dimension();
    da.leftCols(B) = at.s1.cwiseProduct(at.dz.leftCols(B));
    for (std::size_t j = 0; j < own.inside.size(); ++j) {
      const Index b = own.inside[j];
      const auto s1 = at.s1.col(b).array(), s2 = at.s2.col(b).array(), s3 = at.s3.col(b).array();
      const auto z = lanes(at.z, own, j), dz = lanes(at.dz, own, j);
      const auto change = at.dz.col(b).array();
      auto out = lanes(da, own, j);
      own.room = (s2 * change).matrix();
      out = (dz.array().colwise() * s1 + z.array().colwise() * own.room.array()).matrix();
      own.room = z.leftCols(d).cwiseProduct(dz.leftCols(d)).rowwise().sum();
      out.col(d).array() +=
          2 * s2 * own.room.array() + s3 * change * at.squares.col(static_cast<Index>(j)).array();
    }
  }
  // g_L = u, and below, with h = W_lᵀ g_l,
  //   g_Δ = s' h_Δ,  gᵢ = s' hᵢ + 2 s'' ∂ᵢz h_Δ,
  //   g = s' h + s'' (Σ ∂ᵢz hᵢ + Δz h_Δ) + s''' Σ (∂ᵢz)² h_Δ
  void backward(BatchRef u, Passes& own) const {
    const Index B = own.samples, d = dimension();
    Matrix& top = own.layers.back().g;
    top.leftCols(B) = u.row(0);
    for (std::size_t j = 0; j < own.inside.size(); ++j) {
      lanes(top, own, j).setZero();
      lanes(top, own, j)(0, d) = u(1, own.inside[j]);
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
        h.leftCols(d).array() += z.leftCols(d).array().colwise() * own.room.array();
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

  std::vector<Index> widths_;
  Real deviation_;
};

// y = ⟨c, x⟩ for the weights c (2, B) of the samples.
class WeightedResidual final : public Physics {
 public:
  Index inputs() const override { return 2; }
  Index outputs() const override { return 1; }
  void forward(BatchRef x, BatchRef c, BatchOut y, Workspace&) const override {
    y = x.cwiseProduct(c).colwise().sum();
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Jv = v.cwiseProduct(w.context).colwise().sum();
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    JTu = (w.context.array().rowwise() * u.row(0).array()).matrix();
  }
};

// An equation by its solution u* and its right side f = −Δu*, with the published settings.
struct Equation {
  Index dimension;
  const char* layers;
  Index interior, boundary;
  const char* points;
  Real boundary_weight;  // β
  Real deviation;        // of the start
  Real (*solution)(VectorRef p);
  Real (*source)(VectorRef p);
};

constexpr Real kPi = std::numbers::pi;
const Equation kEquations[] = {
    {2, "32", 784, 120, "grid", 4, 0.1,
     [](VectorRef p) { return std::sin(kPi * p[0]) * std::sin(kPi * p[1]); },
     [](VectorRef p) { return 2 * kPi * kPi * std::sin(kPi * p[0]) * std::sin(kPi * p[1]); }},
    {5, "64-64-48-48", 3000, 500, "fresh", 1, 0,
     [](VectorRef p) -> Real { return (kPi * p.array()).cos().sum(); },
     [](VectorRef p) -> Real { return kPi * kPi * (kPi * p.array()).cos().sum(); }},
    {10, "256-256-128-128", 100, 50, "fresh", 1, 0,
     [](VectorRef p) {
       Real sum = 0;
       for (Index i = 0; i < p.size(); i += 2) sum += p[i] * p[i + 1];
       return sum;
     },
     [](VectorRef) -> Real { return 0; }}};

struct PinnPoisson {
  std::string mode = kLearnMode, layers, points;
  Index dimension = 2, interior = 0, boundary = 0;
};
void fields(PinnPoisson& o, auto& field) {
  field(kModeOption, o.mode, {kDirectMode, kLearnMode}, "learn: the unknown is a network");
  field("dimension", o.dimension, between(2, 10),
        "d: 2, 5 or 10, each with its published settings");
  field("layers", o.layers, Choices{},
        "widths of the hidden layers; by default the published ones");
  field("points", o.points, Choices{"", "grid", "fixed", "fresh"},
        "collocation points: a regular grid, for d = 2; random ones; new ones in each step; by "
        "default as published");
  field("interior", o.interior, between(0, 1e5), "N_Ω, points in Ω; 0: as published");
  field("boundary", o.boundary, between(0, 1e5), "N_∂, points on ∂Ω; 0: as published");
}

// The points of a batch: those in Ω first.
class Collocation {
 public:
  Collocation(const Equation& of, Index interior, Index boundary, bool is_grid)
      : of_(of), interior_(interior), boundary_(boundary), is_grid_(is_grid) {
    side_ = static_cast<Index>(std::lround(std::sqrt(static_cast<Real>(interior))));
    require(!is_grid || (of.dimension == 2 && side_ * side_ == interior && boundary % 4 == 0 &&
                         boundary > 4 && points() != kValidation),
            "points=grid requires dimension=2, a square of a whole number as interior, and as "
            "boundary a multiple of 4 above 4");
  }
  static constexpr Index kValidation = 1024;
  Index points() const { return interior_ + boundary_; }

  // A batch of another size is that of the validation: random points in the same proportion.
  void draw(RandomStream& stream, Index b, Batch& batch) const {
    const Index count = batch.samples(), d = of_.dimension;
    const Index inside = count * interior_ / points();
    const bool is_inside = b < inside;
    auto p = batch.input.col(b).head(d);
    if (is_grid_ && count == points())
      is_inside ? place_inside(b, p) : place_on_side(b - inside, p);
    else
      is_inside ? place(stream, p) : place_on_face(stream, p);
    const Real u = of_.solution(p), laplacian = is_inside ? -of_.source(p) : 0;
    const auto B = static_cast<Real>(count),
               N = static_cast<Real>(is_inside ? inside : count - inside);
    batch.input(d, b) = is_inside ? 1 : 0;
    batch.truth.col(b) << u, laplacian;
    batch.context.col(b).setZero();
    batch.context(is_inside ? 1 : 0, b) = std::sqrt((is_inside ? 1 : of_.boundary_weight) * B / N);
    batch.target(0, b) = batch.context.col(b).dot(batch.truth.col(b));
  }

 private:
  static void place(RandomStream& stream, VectorOut p) {
    for (Index i = 0; i < p.size(); ++i) p[i] = stream.uniform();
  }
  static void place_on_face(RandomStream& stream, VectorOut p) {
    place(stream, p);
    const auto face = static_cast<Index>(stream.uniform() * 2 * static_cast<Real>(p.size()));
    p[face / 2] = static_cast<Real>(face % 2);
  }
  void place_inside(Index b, VectorOut p) const {
    const auto cells = static_cast<Real>(side_ + 1);
    p << static_cast<Real>(b % side_ + 1) / cells, static_cast<Real>(b / side_ + 1) / cells;
  }
  void place_on_side(Index b, VectorOut p) const {
    const Index along = boundary_ / 4, face = b / along;
    p[face / 2] = static_cast<Real>(face % 2);
    p[1 - face / 2] = static_cast<Real>(b % along) / static_cast<Real>(along - 1);
  }

  const Equation& of_;
  Index interior_, boundary_, side_;
  bool is_grid_;
};

// ‖u − u*‖/‖u*‖ over the samples in Ω
Real relative_error(BatchRef x, const Batch& batch) {
  Real gap = 0, whole = 0;
  for (Index b = 0; b < x.cols(); ++b) {
    if (batch.context(1, b) == 0) continue;
    gap += std::pow(x(0, b) - batch.truth(0, b), 2);
    whole += std::pow(batch.truth(0, b), 2);
  }
  return std::sqrt(gap / whole);
}

std::vector<Index> widths_of(Index dimension, const std::string& layers) {
  constexpr std::size_t kDigits = 4;
  std::vector<Index> widths{dimension};
  std::istringstream text(layers + '-');
  for (std::string width; std::getline(text, width, '-');) {
    const bool is_whole = width.find_first_not_of("0123456789") == std::string::npos;
    require(is_whole && !width.empty() && width.size() <= kDigits && width[0] != '0',
            "pinn-poisson: layers must be widths from 1 to 9999 joined by '-', as in 64-48-32");
    widths.push_back(std::stoi(width));
  }
  widths.push_back(1);
  return widths;
}

ProblemParts make_pinn_poisson(const PinnPoisson& o, const Draw& draw) {
  require(o.mode == kLearnMode, "pinn-poisson has only mode=learn; remove mode=direct");
  const auto found = std::ranges::find(kEquations, o.dimension, &Equation::dimension);
  require(found != std::end(kEquations), "pinn-poisson: dimension must be 2, 5 or 10");
  const Equation& of = *found;
  const Index interior = o.interior > 0 ? o.interior : of.interior;
  const Index boundary = o.boundary > 0 ? o.boundary : of.boundary;
  const std::string points = o.points.empty() ? of.points : o.points;
  const Collocation collocation(of, interior, boundary, points == "grid");
  const Index count = collocation.points();
  const Learning learning{.mode = o.mode, .batch = count, .data = points == "fresh" ? 0 : count};
  ProblemParts parts{
      .physics = std::make_unique<WeightedResidual>(),
      .network = std::make_unique<LaplacianPerceptron>(
          widths_of(of.dimension, o.layers.empty() ? of.layers : o.layers), of.deviation),
      .x_error = relative_error,
      .x_scale = 1,
      .samples = {.validation = Collocation::kValidation,
                  .contexts = 2,
                  .draw = [collocation](RandomStream& stream, Index b, Batch& batch) {
                    collocation.draw(stream, b, batch);
                  }}};
  return learn(learning, {.inputs = of.dimension + 1, .outputs = 2}, draw, std::move(parts));
}

}  // namespace

void register_pinn_poisson(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "pinn-poisson",
       .title = "Poisson's equation by a network",
       .group = Group::physics,
       .formula = "L = ½(1/N_Ω Σ(Δu + f)² + β/N_∂ Σ(u − u*)²),  u = N(p; θ)",
       .source = "Müller, Zeinhofer (2023); Guzmán-Cordero, Dangel, Goldshlager, Zeinhofer (2025)",
       .note = "A physics-informed network; a sample is a collocation point. dimension=2 has 129 "
               "unknowns and a grid of 904 points, 5 has 10,065 and 3,500 new points in each step, "
               "10 has 118,145 and 150. The error in x is the relative L2 error on fixed points.",
       .aim = Aim::x,
       .in_all = false,
       .panels = {{.title = "Relative L2 error", .kind = "curve"}}},
      make_pinn_poisson));
}

}  // namespace isoline::problems
