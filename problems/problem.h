// The inverse problem: θ ──network──▶ x ──physics──▶ y ──loss──▶ L, with the target y*. A direct
// problem is one with the identity network. Const: what depends on θ lives in a Point.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/options.h"
#include "core/oracle.h"
#include "core/random.h"
#include "core/registry.h"
#include "networks/network.h"
#include "problems/loss.h"
#include "problems/physics.h"

namespace isoline {

// The forward pass at θ and what its products need. Owned by the caller and reused.
struct Point {
  Matrix y;  // (m, B)
  Real loss = 0;
  Workspace physics, network;
  Matrix scratch_x;  // (k, B)

  const Matrix& x() const { return physics.x; }  // (k, B)
};

// What a problem is made of. A direct problem leaves network and input empty.
struct ProblemParts {
  std::unique_ptr<Physics> physics;
  Vector start;                      // θ₀, (n)
  Matrix target;                     // y*, (m, B)
  std::unique_ptr<Network> network;  // identity where empty
  Matrix input;                      // what the network sees, (i, B)
  Matrix context;                    // c, (p, B)
  std::unique_ptr<Loss> loss;        // ½‖y − y*‖² where empty
  std::optional<Real> minimum;       // f_L, least loss attainable, where known
  std::optional<Matrix> truth;       // the x* that made y*, (k, B), where there is one
  // Distance from x to the nearest solution, where the solutions are known.
  std::function<Real(BatchRef x)> x_error;
  // Where to draw the landscape of a two-dimensional problem: low and high corner in x.
  std::optional<std::array<Real, 4>> window;    // x1 low, x1 high, x2 low, x2 high
  std::optional<std::array<Real, 4>> y_window;  // of y; what the window maps into where empty
  std::string contour_spacing = "logarithm";    // or "fifth root", or "powers of two"
};

class Problem {
 public:
  explicit Problem(ProblemParts parts);

  Index unknowns() const { return parts_.start.size(); }       // n
  Index inputs() const { return parts_.physics->inputs(); }    // k
  Index outputs() const { return parts_.physics->outputs(); }  // m
  Index samples() const { return parts_.target.cols(); }       // B
  Index residuals() const { return parts_.target.size(); }     // m·B, rows of J
  const Vector& start() const { return parts_.start; }
  const Matrix& target() const { return parts_.target; }
  std::optional<Real> minimum() const { return parts_.minimum; }
  const std::optional<Matrix>& truth() const { return parts_.truth; }
  const auto& window() const { return parts_.window; }
  const auto& y_window() const { return parts_.y_window; }
  const std::string& contour_spacing() const { return parts_.contour_spacing; }
  std::vector<Block> layout() const { return parts_.network->layout(); }
  bool has_identity_network() const { return parts_.network->is_identity(); }
  Inverse inverse_kind() const { return parts_.physics->inverse_kind(); }
  Real x_error(BatchRef x) const;  // nan where no solution is known

  OracleSet offers() const;
  std::array<std::int64_t, kOracles> prices() const;  // declared, in forwards

  void forward(VectorRef theta, Point& at) const;
  // The physics again at a given x, network left out: for inverting the physics alone.
  Real physics_misfit(BatchRef y, BatchRef x, Point& scratch, BatchOut gradient) const;

  Real loss_of(BatchRef y) const;                                        // L at any y, (m, B)
  void cotangent(const Point& at, BatchOut g) const;                     // g = ∂L/∂y, (m, B)
  void loss_curvature(const Point& at, BatchRef dy, BatchOut dg) const;  // (∂²L/∂y²) dy
  void residual(const Point& at, VectorOut r) const;                  // r = (y − y*)/√B, (m·B)
  void pullback(BatchRef w, VectorOut out, Point& at) const;          // Jᵀ w, (m, B) -> (n)
  void pushforward(VectorRef v, BatchOut out, Point& at) const;       // J v, (n) -> (m, B)
  void network_pullback(BatchRef w, VectorOut out, Point& at) const;  // (k, B) -> (n)
  void jacobian(Matrix& J, Point& at) const;                          // (m·B, n)
  void hessian(Matrix& H, Point& at) const;                   // ∇²L, (n, n), identity network
  void curvature(BatchRef w, BatchOut out, Point& at) const;  // (k, k·B)
  Success local_inverse(BatchRef y, BatchOut x, Point& at) const;

 private:
  ProblemParts parts_;
};

// What an entry draws its instance from. Seed 0 is the published one.
class Draw {
 public:
  Draw(std::uint64_t seed, std::string problem) : seed_(seed), problem_(std::move(problem)) {}
  bool is_published() const { return seed_ == 0; }
  RandomStream stream(std::string_view purpose, std::uint64_t index = 0) const {
    return {seed_, problem_, purpose, index};
  }
  // standard + 0.1 max(1, |standard|) N(0, 1), the standard start itself for seed 0.
  Vector start(const Vector& standard) const;

 private:
  std::uint64_t seed_;
  std::string problem_;  // without options: sweeps see the same draws
};

struct ProblemEntry {
  std::string name, title;
  std::string formula;    // plain text with the mathematical letters of Unicode
  std::string source;     // author, year, equation
  std::string note = {};  // deviations and what a reader should know
  OptionTable options = {};
  int revision = 1;  // raised when results change
  std::function<Problem(const Json& complete_options, const Draw&)> make = {};
};
using ProblemRegistry = Registry<ProblemEntry>;

// An entry whose `make` is given as a function of the options struct and the draw.
template <class Options>
ProblemEntry problem_entry(ProblemEntry entry, ProblemParts (*make)(const Options&, const Draw&)) {
  entry.options = option_table<Options>();
  entry.make = [make](const Json& options, const Draw& draw) {
    return Problem(make(read_options<Options>(options), draw));
  };
  return entry;
}

void register_problems(ProblemRegistry& registry);  // generated: one call a file

}  // namespace isoline
