// An unknown diffusivity e^m in −∇·(e^m ∇u) = f on the unit square, u = 0 around it, all at once: m
// and u at the n×n interior nodes of a grid of width h = 1/(n + 1) are the unknowns, and the
// equation is among the residuals. With the flux between neighbours i and j through their geometric
// mean,
//
//   y = ( Σⱼ e^((mᵢ + mⱼ)/2) (uᵢ − uⱼ),  uᵢ,  Σⱼ (mᵢ − mⱼ) ),
//
// the source times h², the observed state, and a prior of a smooth m at the nodes with four
// neighbours. Without the latter, an m of alternating signs has no effect. x* is m* = x₁² − x₂² +
// 2x₁x₂, whose prior vanishes, and u* = sin πx₁ sin πx₂; other instances turn m* by an angle, as
// √2 ((x₁² − x₂²) cos β + 2x₁x₂ sin β). Haber and Ascher (2001) state such problems in this form.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "problems/learning.h"

namespace isoline::problems {
namespace {

struct Diffusivity {
  Index n = 16, refine = 1;
};
void fields(Diffusivity& o, auto& field) {
  field("n", o.n, between(3, 1024), "nodes along each side");
  field("refine", o.refine, between(1, 16),
        "sources of the data from a grid so many times as fine");
}

// A node i = row + n column and its neighbours on the grid, ascending.
struct Stencil {
  std::array<int, 5> node{};
  int size = 0;

  Stencil(int i, int n) {
    const int row = i % n, column = i / n;
    if (column > 0) add(i - n);
    if (row > 0) add(i - 1);
    add(i);
    if (row + 1 < n) add(i + 1);
    if (column + 1 < n) add(i + n);
  }
  bool is_whole() const { return size == 5; }
  int missing() const { return 5 - size; }  // neighbours outside, where u = 0 and m = mᵢ
  const int* begin() const { return node.data(); }
  const int* end() const { return node.data() + size; }

 private:
  void add(int i) { node[static_cast<std::size_t>(size++)] = i; }
};

SparsePattern pattern_of(int n) {
  SparsePattern pattern;
  const int nodes = n * n;
  const auto end_row = [&] {
    pattern.row_start.push_back(static_cast<int>(pattern.column.size()));
  };
  pattern.columns = 2 * nodes;
  for (int i = 0; i < nodes; ++i) {
    for (const int j : Stencil(i, n)) pattern.column.push_back(j);
    for (const int j : Stencil(i, n)) pattern.column.push_back(nodes + j);
    end_row();
  }
  for (int i = 0; i < nodes; ++i) {
    pattern.column.push_back(nodes + i);
    end_row();
  }
  for (int i = 0; i < nodes; ++i) {
    const Stencil stencil(i, n);
    if (!stencil.is_whole()) continue;
    pattern.column.insert(pattern.column.end(), stencil.begin(), stencil.end());
    end_row();
  }
  set_single_blocks(pattern);
  return pattern;
}

class Diffusion final : public BySparseJacobian {
 public:
  explicit Diffusion(int n) : BySparseJacobian(pattern_of(n)), n_(n) {}

  void forward(BatchRef x, BatchRef, BatchOut y, Workspace& w) const override {
    const VectorRef m = x.col(0).head(nodes()), u = x.col(0).tail(nodes());
    if (w.saved.size() < 2) w.saved.resize(2);  // the first one holds the values of J
    w.saved[1] = (0.5 * m.array()).exp();
    const Real* const root = w.saved[1].data();  // e^(mᵢ/2)
    Index prior = 2 * Index{nodes()};
    for (int i = 0; i < nodes(); ++i) {
      const Stencil stencil(i, n_);
      Real flux = stencil.missing() * root[i] * u[i], bend = 0;
      for (const int j : stencil) {
        flux += root[j] * (u[i] - u[j]);
        bend += m[i] - m[j];
      }
      y(i, 0) = root[i] * flux;
      if (stencil.is_whole()) y(prior++, 0) = bend;
    }
    y.col(0).segment(nodes(), nodes()) = u;
  }

  void sparse_jacobian(VectorOut values, Workspace& w) const override {
    const VectorRef u = w.x.col(0).tail(nodes());
    const Real* const root = w.saved[1].data();
    Real* out = values.data();
    for (int i = 0; i < nodes(); ++i) {
      const Stencil stencil(i, n_);
      const Real outside = stencil.missing() * root[i] * root[i];
      Real* const by_m = out;
      Real* const by_u = by_m + stencil.size;
      out = by_u + stencil.size;
      int own = 0;
      for (int k = 0; k < stencil.size; ++k)
        if (stencil.begin()[k] == i) own = k;
      by_m[own] = outside * u[i];
      by_u[own] = outside;
      for (int k = 0; k < stencil.size; ++k) {
        const int j = stencil.begin()[k];
        if (j == i) continue;
        const Real conductance = root[i] * root[j];
        by_m[k] = 0.5 * conductance * (u[i] - u[j]);
        by_u[k] = -conductance;
        by_m[own] += by_m[k];
        by_u[own] += conductance;
      }
    }
    out = std::fill_n(out, nodes(), 1);
    for (int i = 0; i < nodes(); ++i) {
      const Stencil stencil(i, n_);
      if (!stencil.is_whole()) continue;
      for (const int j : stencil) *out++ = j == i ? 4 : -1;
    }
  }

 private:
  int nodes() const { return n_ * n_; }
  int n_;
};

Vector truth_of(Index n, const Draw& draw) {
  const Real beta = 2 * std::numbers::pi * draw.stream("target").uniform();
  const Real a = draw.is_published() ? 1 : std::numbers::sqrt2 * std::cos(beta);
  const Real b = draw.is_published() ? 1 : std::numbers::sqrt2 * std::sin(beta);
  const Index nodes = n * n;
  Vector truth(2 * nodes);
  for (Index i = 0; i < nodes; ++i) {
    const Real width = 1 / static_cast<Real>(n + 1);
    const Real x1 = static_cast<Real>(i % n + 1) * width;
    const Real x2 = static_cast<Real>(i / n + 1) * width;
    truth[i] = a * (x1 * x1 - x2 * x2) + b * 2 * x1 * x2;
    truth[nodes + i] = std::sin(std::numbers::pi * x1) * std::sin(std::numbers::pi * x2);
  }
  return truth;
}

ProblemParts make_diffusivity(const Diffusivity& o, const Draw& draw) {
  const Vector truth = truth_of(o.n, draw);
  ProblemParts parts =
      from_exact_data(std::make_unique<Diffusion>(static_cast<int>(o.n)), truth, draw);
  Vector start = truth;  // u as observed, and a diffusivity of 1
  start.head(o.n * o.n).setZero();
  parts.start = draw.start(start);
  if (o.refine == 1) return parts;
  const Index n = o.refine * (o.n + 1) - 1;
  const Diffusion finer(static_cast<int>(n));
  Matrix y(finer.outputs(), 1);
  Workspace w;
  finer.forward(truth_of(n, draw), Matrix(0, 1), y, w);
  const auto area = static_cast<Real>(o.refine * o.refine);  // h² over that of the finer grid
  for (Index i = 0; i < o.n * o.n; ++i) {
    const Index row = o.refine * (i % o.n + 1) - 1, column = o.refine * (i / o.n + 1) - 1;
    parts.target(i, 0) = area * y(row + n * column, 0);
  }
  return parts;
}

}  // namespace

void register_diffusivity(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "diffusivity",
       .title = "Diffusivity of a field, with its state as unknowns",
       .group = Group::physics,
       .formula = "−∇·(e^m ∇u) = f,  x = (m, u),  L = ½‖y − y*‖²",
       .source = "Haber, Ascher (2001), all-at-once form",
       .note = "The Jacobian is sparse: each row has at most ten values. The data are exact, and "
               "the standard start is m = 0 with u as observed.",
       .aim = Aim::x,
       .family = "diffusion",
       .in_all = false},
      make_diffusivity));
}

}  // namespace isoline::problems
