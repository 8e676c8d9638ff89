// Bundle adjustment: Agarwal, Snavely, Seitz, Szeliski (2010), "Bundle Adjustment in the Large".
// Cameras of 9 unknowns (angle-axis ω, translation t, focal length f, distortion k₁, k₂) see points
// X of 3; an observation is
//   P = R(ω) X + t,  p = −(P₁, P₂)/P₃,  y = f (1 + k₁‖p‖² + k₂‖p‖⁴) p,  L = ½ Σ ‖y − y*‖².
// x lists the cameras, then the points. The scene is a file of the set, or one of our own with
// known truth and normal noise of y*. Scenes that differ by rotation, translation and scale have
// one y: the error in x is that of the points after the best of these (Umeyama, 1991), in root mean
// square.
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/decompose.h"
#include "core/files.h"
#include "core/numbers.h"
#include "core/shell.h"
#include "core/text.h"
#include "problems/jet.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

constexpr int kCamera = 9, kPoint = 3;  // unknowns

struct Observation {
  int camera, point;
};

using Turn = Jet<Real, 3>;
using Rotation = std::array<Turn, 9>;  // by rows, with its derivatives by ω

// R(ω), Rodrigues' formula; of first order at ω = 0, where it is not differentiable as written.
Rotation rotation(const Real* omega) {
  std::array<Turn, 3> w;
  for (int i = 0; i < 3; ++i) {
    w[i] = omega[i];
    w[i].by[i] = 1;
  }
  const Turn square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
  Turn cosine = 1, first = 1, second = 0.5;  // cos θ, sin θ/θ, (1 − cos θ)/θ²
  constexpr Real kSmall = 1e-16;             // of θ², whose next terms are below rounding
  if (square.value > kSmall) {
    const Turn angle = sqrt(square);
    cosine = cos(angle);
    first = sin(angle) / angle;
    second = (1 - cosine) / square;
  }
  return {cosine + second * w[0] * w[0],       second * w[0] * w[1] - first * w[2],
          second * w[0] * w[2] + first * w[1], second * w[0] * w[1] + first * w[2],
          cosine + second * w[1] * w[1],       second * w[1] * w[2] - first * w[0],
          second * w[0] * w[2] - first * w[1], second * w[1] * w[2] + first * w[0],
          cosine + second * w[2] * w[2]};
}

// y from (P, f, k₁, k₂).
template <class T>
std::array<T, 2> image_of(const T* q) {
  const T u = -q[0] / q[2], v = -q[1] / q[2];
  const T square = u * u + v * v;
  const T scale = q[3] * (T(1) + square * (q[4] + square * q[5]));
  return {scale * u, scale * v};
}

SparsePattern pattern_of(const std::vector<Observation>& seen, int cameras, int points) {
  SparsePattern pattern;
  pattern.columns = Index{kCamera} * cameras + Index{kPoint} * points;
  pattern.first_eliminated = cameras;
  for (int j = 0; j <= cameras; ++j) pattern.parameter_block.push_back(kCamera * j);
  for (int j = 1; j <= points; ++j)
    pattern.parameter_block.push_back(kCamera * cameras + kPoint * j);
  pattern.residual_block.push_back(0);
  for (const Observation& each : seen) {
    for (int row = 0; row < 2; ++row) {
      for (int i = 0; i < kCamera; ++i) pattern.column.push_back(kCamera * each.camera + i);
      for (int i = 0; i < kPoint; ++i)
        pattern.column.push_back(kCamera * cameras + kPoint * each.point + i);
      pattern.row_start.push_back(static_cast<int>(pattern.column.size()));
    }
    pattern.residual_block.push_back(static_cast<int>(pattern.row_start.size()) - 1);
  }
  return pattern;
}

class Projection final : public BySparseJacobian {
 public:
  Projection(std::vector<Observation> seen, int cameras, int points)
      : BySparseJacobian(pattern_of(seen, cameras, points)),
        seen_(std::move(seen)),
        cameras_(cameras) {}

  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override {
    Real* out = y.data();
    for_each(x.col(0), [&](const Rotation&, const Real*, const std::array<Real, 6>& q) {
      for (const Real each : image_of(q.data())) *out++ = each;
    });
  }

  // By the chain rule: y of P, f, k₁, k₂; P of t and X; and of ω by R's derivatives, which all
  // observations of a camera share.
  void sparse_jacobian(VectorOut values, Workspace& w) const override {
    using Image = Jet<Real, 6>;
    Real* out = values.data();
    for_each(w.x.col(0), [&](const Rotation& R, const Real* X, const std::array<Real, 6>& at) {
      std::array<Image, 6> q;
      Real by_turn[3][3];  // ∂Pᵢ/∂ωⱼ
      for (int i = 0; i < 6; ++i) {
        q[i] = at[i];
        q[i].by[i] = 1;
      }
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          by_turn[i][j] =
              R[3 * i].by[j] * X[0] + R[3 * i + 1].by[j] * X[1] + R[3 * i + 2].by[j] * X[2];
      for (const Image& image : image_of(q.data())) {
        const auto& by = image.by;
        for (int j = 0; j < 3; ++j)
          *out++ = by[0] * by_turn[0][j] + by[1] * by_turn[1][j] + by[2] * by_turn[2][j];
        for (int j = 0; j < 6; ++j) *out++ = by[j];
        for (int j = 0; j < 3; ++j)
          *out++ = by[0] * R[j].value + by[1] * R[3 + j].value + by[2] * R[6 + j].value;
      }
    });
  }

 private:
  // R, X and (P, f, k₁, k₂) of each observation.
  template <class Visit>
  void for_each(VectorRef x, Visit visit) const {
    thread_local std::vector<Rotation> turned;
    turned.resize(static_cast<std::size_t>(cameras_));
    for (int c = 0; c < cameras_; ++c)
      turned[static_cast<std::size_t>(c)] = rotation(x.data() + kCamera * c);
    for (const Observation& each : seen_) {
      const Rotation& R = turned[static_cast<std::size_t>(each.camera)];
      const Real* X = x.data() + kCamera * cameras_ + kPoint * each.point;
      const Real* camera = x.data() + kCamera * each.camera;
      std::array<Real, 6> q;
      for (int i = 0; i < 3; ++i) {
        q[i] = R[3 * i].value * X[0] + R[3 * i + 1].value * X[1] + R[3 * i + 2].value * X[2] +
               camera[3 + i];
        q[3 + i] = camera[6 + i];
      }
      visit(R, X, q);
    }
  }

  std::vector<Observation> seen_;
  int cameras_;
};

struct Scene {
  int cameras = 0, points = 0;
  std::vector<Observation> seen;
  Matrix target;  // y*, (2 observations, 1)
  Vector start;   // (n)
};

// --- files of the set

// The named file, or that name in the folder that ISOLINE_BAL names, compressed or not.
std::filesystem::path path_of(const std::string& file) {
  const char* const folder = std::getenv("ISOLINE_BAL");
  for (const std::filesystem::path& in : {std::filesystem::path(folder ? folder : ""), {}})
    for (const char* ending : {"", ".bz2"})
      if (const std::filesystem::path path = in / (file + ending); is_there(path)) return path;
  throw NotApplicable(fmt::format(
      "the file {} is missing: set the environment variable ISOLINE_BAL to the folder that "
      "contains it",
      file));
}

std::string text_of(const std::filesystem::path& path) {
  if (path.extension() != ".bz2") return read_text(path);
  require(std::filesystem::is_regular_file(path),
          [&] { return fmt::format("cannot read {}: it is not a file", path.string()); });
  FILE* const pipe =
      popen(fmt::format("bzip2 -dc {} 2> /dev/null", shell_word(path.string())).c_str(), "r");
  std::string text;
  std::array<char, 1 << 16> part;
  for (std::size_t read = 1; pipe != nullptr && read > 0;)
    text.append(part.data(), read = std::fread(part.data(), 1, part.size(), pipe));
  require(pipe != nullptr && pclose(pipe) == 0, [&] {
    return fmt::format("{}: bzip2 cannot decompress it: it is damaged, or bzip2 is not installed",
                       path.string());
  });
  return text;
}

// The numbers of a file, one after the other.
struct Numbers {
  std::string_view rest;
  const std::string& file;
  std::int64_t count = 0, line = 1;

  bool is_used_up() {
    const std::size_t skipped = std::min(rest.find_first_not_of(" \t\r\n"), rest.size());
    line += std::ranges::count(rest.substr(0, skipped), '\n');
    rest.remove_prefix(skipped);
    return rest.empty();
  }
  Real next() {
    ++count;
    const bool is_over = is_used_up();
    const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n"));
    const std::optional<Real> value = number_in(word);
    require(!is_over && value && std::isfinite(*value), [&] {
      return is_over ? fmt::format("{}: it ends at line {} before number {}", file, line, count)
                     : fmt::format("{}: line {}: number {} is '{}', not a finite number", file,
                                   line, count, cut(word, 40));
    });
    rest.remove_prefix(word.size());
    return *value;
  }
  int index(int below, const char* what) {
    const Real value = next();
    require(value >= 0 && value < below && value == std::floor(value), [&] {
      return fmt::format("{}: line {}: {} is {}, not a whole number from 0 to {}", file, line, what,
                         value, below - 1);
    });
    return static_cast<int>(value);
  }
};

Scene scene_of(const std::string& file) {
  constexpr int kMost = 50'000'000;  // of cameras, points and observations: above all files
  const std::string text = text_of(path_of(file));
  Numbers numbers{without_byte_order_mark(text), file};
  Scene scene;
  scene.cameras = numbers.index(kMost, "the number of cameras");
  scene.points = numbers.index(kMost, "the number of points");
  const int observations = numbers.index(kMost, "the number of observations");
  scene.target.resize(Index{2} * observations, 1);
  for (int i = 0; i < observations; ++i) {
    const int camera = numbers.index(scene.cameras, "the index of a camera");
    const int point = numbers.index(scene.points, "the index of a point");
    scene.seen.push_back({camera, point});
    for (int row = 0; row < 2; ++row) scene.target(Index{2} * i + row, 0) = numbers.next();
  }
  scene.start.resize(Index{kCamera} * scene.cameras + Index{kPoint} * scene.points);
  for (Real& each : scene.start) each = numbers.next();
  require(numbers.is_used_up(), [&] {
    return fmt::format(
        "{}: line {}: more numbers follow than its header names: {} cameras, {} points and {} "
        "observations take {} numbers",
        file, numbers.line, scene.cameras, scene.points, observations, numbers.count);
  });
  return scene;
}

// --- a scene of our own

struct Bal {
  std::string file;
  Index cameras = 8, points = 100, views = 4;
  Real noise = 0.5;
};
void fields(Bal& o, auto& field) {
  field("file", o.file, Choices{},
        "file of the set, in the folder ISOLINE_BAL or the current one; none: a synthetic scene");
  field("cameras", o.cameras, between(2, 10000), "number of cameras of a synthetic scene");
  field("points", o.points, between(8, 1e6), "number of points of a synthetic scene");
  field("views", o.views, between(2, 100), "cameras that see each point, at most all");
  field("sigma", o.noise, at_least(0), "standard deviation of y*, in pixels");
}

// Cameras at a distance of 10 around points within 2 of the origin, each point seen by neighbours.
// The start is off by some percent, without distortion.
Vector draw_scene(const Bal& o, RandomStream stream, Scene& scene) {
  constexpr Real kDistance = 10, kExtent = 2, kFocal = 500;
  constexpr Real kDistortion[] = {-0.05, 0.01}, kArc = 3;  // within ±π
  scene.cameras = static_cast<int>(o.cameras);
  scene.points = static_cast<int>(o.points);
  const int views = static_cast<int>(std::min(o.views, o.cameras));
  Vector truth(kCamera * o.cameras + kPoint * o.points), noise;
  for (Index c = 0; c < o.cameras; ++c) {
    noise = stream.normal_vector(kCamera);
    const Real turn = kArc * (2 * static_cast<Real>(c) / static_cast<Real>(o.cameras) - 1);
    truth.segment(kCamera * c, kCamera) << 0.2 * noise[0], turn, 0.2 * noise[2], 0.2 * noise[3],
        0.2 * noise[4], -kDistance + 0.2 * noise[5], kFocal * (1 + 0.05 * noise[6]),
        kDistortion[0] * (1 + 0.1 * noise[7]), kDistortion[1] * (1 + 0.1 * noise[8]);
  }
  truth.tail(kPoint * o.points) = stream.uniform_vector(kPoint * o.points, -kExtent, kExtent);
  const Vector first =
      stream.uniform_vector(o.points, 0, static_cast<Real>(scene.cameras - views + 1));
  for (int p = 0; p < scene.points; ++p)
    for (int c = 0; c < views; ++c) scene.seen.push_back({static_cast<int>(first[p]) + c, p});
  scene.start = truth;
  for (Index c = 0; c < o.cameras; ++c) {
    auto camera = scene.start.segment(kCamera * c, kCamera);
    noise = stream.normal_vector(7);
    camera.head(3) += 0.01 * noise.head(3);
    camera.segment(3, 3) += 0.05 * noise.segment(3, 3);
    camera[6] *= 1 + 0.02 * noise[6];
    camera.tail(2).setZero();
  }
  scene.start.tail(kPoint * o.points) += 0.05 * stream.normal_vector(kPoint * o.points);
  return truth;
}

// The points after the best rotation, translation and scale.
Real distance_to(const Matrix& truth, Matrix points) {  // (3, points)
  const Matrix centred = truth.colwise() - truth.rowwise().mean();
  points.colwise() -= points.rowwise().mean().eval();
  Svd svd;
  if (!thin_svd(centred * points.transpose(), svd)) return std::nan("");
  Eigen::Matrix3d U = svd.U;
  const Real sign = Eigen::Matrix3d(U * svd.Vt).determinant() < 0 ? -1 : 1;
  U.col(2) *= sign;
  const Real size = points.squaredNorm();
  const Real scale = size > 0 ? (svd.sigma[0] + svd.sigma[1] + sign * svd.sigma[2]) / size : 0;
  return (centred - scale * (U * svd.Vt) * points).norm() /
         std::sqrt(static_cast<Real>(truth.cols()));
}

// A hundredth of each unknown: files and scenes have rotations that a tenth would turn away.
Start start_near(const Vector& standard, const Draw& draw) {
  if (draw.start_seed() == 0) return standard;
  const Vector drawn = draw.start(standard, StartScale::own).drawn;
  return {Vector(standard + 0.1 * (drawn - standard)), standard};
}

ProblemParts make_bal(const Bal& o, const Draw& draw) {
  if (!o.file.empty()) {
    Scene scene = scene_of(o.file);
    return {.physics = std::make_unique<Projection>(scene.seen, scene.cameras, scene.points),
            .start = start_near(scene.start, draw),
            .start_scale = StartScale::own,
            .target = scene.target};
  }
  Scene scene;
  const Vector truth = draw_scene(o, draw.stream("scene"), scene);
  auto physics = std::make_unique<Projection>(scene.seen, scene.cameras, scene.points);
  Matrix y(physics->outputs(), 1);
  Workspace w;
  physics->forward(truth, Matrix(), y, w);
  y += o.noise * draw.stream("noise").normal_vector(y.size());
  const Matrix points = truth.tail(kPoint * o.points).reshaped(kPoint, o.points);
  ProblemParts parts{.physics = std::move(physics),
                     .start = start_near(scene.start, draw),
                     .start_scale = StartScale::own,
                     .target = y,
                     .truth = truth,
                     .x_error = [points](BatchRef x, const Batch&) {
                       return distance_to(
                           points, x.col(0).tail(points.size()).reshaped(kPoint, points.cols()));
                     }};
  if (o.noise == 0) parts.minimum = 0;
  if (o.noise > 0) parts.noise_level = o.noise * std::sqrt(static_cast<Real>(y.size()));
  return parts;
}

}  // namespace

void register_bal(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "bal",
       .title = "Bundle adjustment",
       .group = Group::physics,
       .formula =
           "P = R(ω)X + t,  p = −(P₁, P₂)/P₃,  y = f(1 + k₁‖p‖² + k₂‖p‖⁴)p,  L = ½Σ‖y − y*‖²",
       .source = "Agarwal, Snavely, Seitz, Szeliski (2010)",
       .note =
           "file=… reads a file of the set “Bundle Adjustment in the Large” from the folder that "
           "the environment variable ISOLINE_BAL names. Without this option, the scene is "
           "synthetic, and the error in x is the root mean square distance of the points after "
           "the best rotation, translation and scale. Starts of other seeds differ by a hundredth "
           "of each unknown.",
       .in_all = false},
      make_bal));
}

}  // namespace isoline::problems
