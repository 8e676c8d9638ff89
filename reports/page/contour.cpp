// Marching squares, the joining of their segments, and the choice of levels.
#include "reports/page/contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <unordered_map>

namespace isoline::reports {
namespace {

// Edges of the grid by number: 2 (i + j n1) leads from (i, j) to (i+1, j), the next to (i, j+1).
using Edge = std::size_t;
struct Segment {
  Edge from, to;
};

class Lattice {
 public:
  explicit Lattice(const Landscape& landscape) : landscape_(landscape) {}
  Index columns() const { return landscape_.loss.rows(); }  // along x1
  Index rows() const { return landscape_.loss.columns(); }  // along x2
  Real loss(Index i, Index j) const { return landscape_.loss(i, j); }
  Edge edge(Index i, Index j, bool is_upward) const {
    return static_cast<Edge>(2 * (i + j * columns()) + (is_upward ? 1 : 0));
  }
  // Where the level crosses an edge.
  Point crossing(Edge edge, Real level) const {
    const bool is_upward = edge % 2 == 1;
    const Index i = static_cast<Index>(edge / 2) % columns();
    const Index j = static_cast<Index>(edge / 2) / columns();
    const Real near = loss(i, j), far = is_upward ? loss(i, j + 1) : loss(i + 1, j);
    const Real t = (level - near) / (far - near);
    const auto& w = landscape_.window;
    const Real u = static_cast<Real>(i) + (is_upward ? 0 : t);
    const Real v = static_cast<Real>(j) + (is_upward ? t : 0);
    return {w[0] + (w[1] - w[0]) * u / static_cast<Real>(columns() - 1),
            w[2] + (w[3] - w[2]) * v / static_cast<Real>(rows() - 1)};
  }

 private:
  const Landscape& landscape_;
};

// The segments of one cell: crossed edges joined in pairs. In a saddle, where all four are crossed,
// the mean of the corners decides which corners are cut off.
void add_segments(const Lattice& grid, Index i, Index j, Real level,
                  std::vector<Segment>& segments) {
  const std::array<Real, 4> corner = {grid.loss(i, j), grid.loss(i + 1, j), grid.loss(i + 1, j + 1),
                                      grid.loss(i, j + 1)};
  const Real mean = (corner[0] + corner[1] + corner[2] + corner[3]) / 4;
  if (!std::isfinite(mean)) return;
  const std::array<Edge, 4> edge = {grid.edge(i, j, false), grid.edge(i + 1, j, true),
                                    grid.edge(i, j + 1, false), grid.edge(i, j, true)};
  std::array<Edge, 4> crossed{};
  std::size_t count = 0;
  for (std::size_t side = 0; side < 4; ++side)
    if ((corner[side] < level) != (corner[(side + 1) % 4] < level)) crossed[count++] = edge[side];
  if (count == 2) segments.push_back({crossed[0], crossed[1]});
  if (count < 4) return;
  const bool is_cut_at_first = (corner[0] < level) != (mean < level);
  segments.push_back({crossed[0], crossed[is_cut_at_first ? 3 : 1]});
  segments.push_back({crossed[2], crossed[is_cut_at_first ? 1 : 3]});
}

// The (at most two) segments that meet at each edge.
using Meetings = std::unordered_map<Edge, std::vector<std::size_t>>;

// Follows segments from `at` until the line ends or closes; marks them used.
std::vector<Edge> follow(Edge at, const std::vector<Segment>& segments, const Meetings& meetings,
                         std::vector<bool>& is_used) {
  std::vector<Edge> line{at};
  for (bool is_open = true; is_open;) {
    is_open = false;
    for (const std::size_t s : meetings.at(line.back())) {
      if (is_used[s]) continue;
      is_used[s] = true;
      line.push_back(segments[s].from == line.back() ? segments[s].to : segments[s].from);
      is_open = true;
      break;
    }
  }
  return line;
}

std::vector<std::vector<Edge>> joined(const std::vector<Segment>& segments) {
  Meetings meetings;
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (const Edge edge : {segments[s].from, segments[s].to}) meetings[edge].push_back(s);
  std::vector<bool> is_used(segments.size(), false);
  std::vector<std::vector<Edge>> lines;
  const auto start_at = [&](std::size_t s, Edge edge) {
    if (!is_used[s]) lines.push_back(follow(edge, segments, meetings, is_used));
  };
  for (std::size_t s = 0; s < segments.size(); ++s)  // open lines first, from their ends
    for (const Edge edge : {segments[s].from, segments[s].to})
      if (meetings[edge].size() == 1) start_at(s, edge);
  for (std::size_t s = 0; s < segments.size(); ++s) start_at(s, segments[s].from);
  return lines;
}

// Between the two in the middle of four values; exact for quadratics. Catmull, Rom (1974).
Real between(const std::array<Real, 4>& p, Real t) {
  const Real a = p[3] - p[0] + 3 * (p[1] - p[2]), b = 2 * p[0] - 5 * p[1] + 4 * p[2] - p[3];
  return p[1] + t * (p[2] - p[0] + t * (b + t * a)) / 2;
}

// (n) values to ((n − 1) times + 1); a parabola continues them past the ends.
std::vector<Real> refined(std::span<const Real> values, std::size_t times) {
  const std::size_t n = values.size();
  const Real before = 3 * (values[0] - values[1]) + values[2];
  const Real after = 3 * (values[n - 1] - values[n - 2]) + values[n - 3];
  std::vector<Real> fine;
  for (std::size_t i = 0; i + 1 < n; ++i)
    for (std::size_t k = 0; k < times; ++k)
      fine.push_back(between({i == 0 ? before : values[i - 1], values[i], values[i + 1],
                              i + 2 == n ? after : values[i + 2]},
                             static_cast<Real>(k) / static_cast<Real>(times)));
  fine.push_back(values[n - 1]);
  return fine;
}

// (n1, n2) to ((n1 − 1) times + 1, n2), transposed: twice is both directions.
Grid refined_and_turned(const Grid& coarse) {
  constexpr Index kTimes = 3;
  Grid fine(coarse.columns(), (coarse.rows() - 1) * kTimes + 1);
  for (Index j = 0; j < coarse.columns(); ++j) {
    const std::vector<Real> values = refined(coarse.column(j), kTimes);
    for (std::size_t i = 0; i < values.size(); ++i) fine(j, static_cast<Index>(i)) = values[i];
  }
  return fine;
}

// Small closed isolines of a coarse grid would be polygons.
Landscape refined(const Landscape& coarse) {
  constexpr Index kLeast = 3;
  const Grid& loss = coarse.loss;
  const bool is_finite =
      std::ranges::all_of(loss.values(), [](Real value) { return std::isfinite(value); });
  if (std::min(loss.rows(), loss.columns()) < kLeast || !is_finite) return coarse;
  return {coarse.window, refined_and_turned(refined_and_turned(loss)), coarse.spacing};
}

std::vector<Real> even_steps(Real low, Real high, int count, Real (*from)(Real)) {
  std::vector<Real> levels;
  for (int i = 1; i <= count; ++i) levels.push_back(from(low + (high - low) * i / (count + 1)));
  return levels;
}

}  // namespace

std::vector<Polyline> isolines(const Landscape& landscape, Real level) {
  const Lattice grid(landscape);
  std::vector<Segment> segments;
  for (Index j = 0; j + 1 < grid.rows(); ++j)
    for (Index i = 0; i + 1 < grid.columns(); ++i) add_segments(grid, i, j, level, segments);
  std::vector<Polyline> lines;
  for (const std::vector<Edge>& edges : joined(segments)) {
    Polyline& line = lines.emplace_back();
    for (const Edge edge : edges) line.push_back(grid.crossing(edge, level));
  }
  return lines;
}

std::vector<Real> contour_levels(const Landscape& landscape) {
  constexpr int kLevels = 13;
  if (landscape.spacing == "powers of two")
    return even_steps(-6, 8, kLevels, [](Real i) { return std::exp2(i); });
  Real low = INFINITY, high = 0;
  for (const Real loss : landscape.loss.values())
    if (std::isfinite(loss) && loss > 0) {
      low = std::min(low, loss);
      high = std::max(high, loss);
    }
  if (!(low < high)) return {};
  if (landscape.spacing == "fifth root")
    return even_steps(0, std::pow(high, 0.2), kLevels, [](Real v) { return std::pow(v, 5); });
  constexpr Real kDecades = 1e-4;  // lower levels crowd around the minimum
  return even_steps(std::log(std::max(low, high * kDecades)), std::log(high), kLevels,
                    [](Real v) { return std::exp(v); });
}

std::string contour_wording(const Landscape& landscape) {
  if (landscape.spacing == "powers of two") return "at 2ⁱ for i = −5 … 7";
  if (landscape.spacing == "fifth root") return "in even steps of its fifth root";
  return "in even steps of its logarithm";
}

std::vector<Contour> contours(const Landscape& landscape) {
  const Landscape fine = refined(landscape);
  std::vector<Contour> all;
  for (const Real level : contour_levels(landscape)) all.push_back({level, isolines(fine, level)});
  return all;
}

}  // namespace isoline::reports
