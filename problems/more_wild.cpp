// The 53 least-squares cases of Moré and Wild (2009), SIAM J. Optim. 20, 172–191, and one of 100
// unknowns: functions of
// Moré, Garbow and Hillstrom (1981), Bdqrtic, Cube, Mancino and Heart (CUTE), with their starts.
// y* = 0, P(x) = f(x), L = ½ Σ fᵢ², half of the published Σ fᵢ². Derivatives are by jets.
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "problems/more_garbow_hillstrom.h"

namespace isoline::problems {
namespace {

// `start` times `factor`, or, where it is empty, all unknowns at `factor`.
struct Case {
  const char* name;
  JetFunction f;
  int n, m;
  std::vector<Real> start;
  Real factor, best;  // best: the least Σ fᵢ² known
};

std::vector<Real> even_start(int n) {  // i/(n + 1)
  std::vector<Real> x;
  for (int i = 1; i <= n; ++i) x.push_back(static_cast<Real>(i) / (n + 1));
  return x;
}
std::vector<Real> mancino_start(int n) {
  std::vector<Real> x;
  for (int i = 1; i <= n; ++i)
    x.push_back(-8.710996e-4 * (mancino_cube(i) + mancino_sum(0.0, i, n)));
  return x;
}

const std::vector<Case>& cases() {
  constexpr Real kRankOne = 8.380281690143324, kRankOneZeros = 9.880597014926506;
  constexpr Real kBardLeast = 0.00821487730657897;
  constexpr Real kWatson6 = 0.00228767005355236, kWatson9 = 1.399760e-6, kWatson12 = 4.722381e-10;
  constexpr Real kBrownDennisLeast = 85822.20162635, kOsborne2Least = 0.0401377362935477;
  const std::vector<Real> helical = {-1, 0, 0}, powell = {3, -1, 0, 1}, freudenstein = {0.5, -2};
  const std::vector<Real> brown_dennis = {25, 5, -5, -1}, valley = {-1.2, 1};
  const std::vector<Real> osborne2 = {1.3, 0.65, 0.65, 0.7, 0.6, 3, 5, 7, 2, 4.5, 5.5};
  const std::vector<Real> heart = {-0.3, -0.39, 0.3, -0.344, -1.2, 2.69, 1.59, -1.5};
  static const std::vector<Case> all = {
      {"linear-full-rank-good-start", kLinearFullRank, 9, 45, {}, 1, 36},
      {"linear-full-rank-bad-start", kLinearFullRank, 9, 45, {}, 10, 36},
      {"linear-rank-one-good-start", kLinearRankOne, 7, 35, {}, 1, kRankOne},
      {"linear-rank-one-bad-start", kLinearRankOne, 7, 35, {}, 10, kRankOne},
      {"linear-rank-one-zeros-good-start", kLinearRankOneZeros, 7, 35, {}, 1, kRankOneZeros},
      {"linear-rank-one-zeros-bad-start", kLinearRankOneZeros, 7, 35, {}, 10, kRankOneZeros},
      {"rosenbrock-good-start", kRosenbrock, 2, 2, valley, 1, 0},
      {"rosenbrock-bad-start", kRosenbrock, 2, 2, valley, 10, 0},
      {"helical-valley-good-start", kHelicalValley, 3, 3, helical, 1, 0},
      {"helical-valley-bad-start", kHelicalValley, 3, 3, helical, 10, 0},
      {"powell-singular-good-start", kPowellSingular, 4, 4, powell, 1, 0},
      {"powell-singular-bad-start", kPowellSingular, 4, 4, powell, 10, 0},
      {"freudenstein-roth-good-start", kFreudensteinRoth, 2, 2, freudenstein, 1, 0},
      {"freudenstein-roth-bad-start", kFreudensteinRoth, 2, 2, freudenstein, 10, 0},
      {"bard-good-start", kBard, 3, 15, {}, 1, kBardLeast},
      {"bard-bad-start", kBard, 3, 15, {}, 10, kBardLeast},
      {"kowalik-osborne",
       kKowalikOsborne,
       4,
       11,
       {0.25, 0.39, 0.415, 0.39},
       1,
       0.00030750560384924},
      {"meyer", kMeyer, 3, 16, {0.02, 4000, 250}, 1, 87.945855170395831},
      {"watson-6-good-start", kWatson, 6, 31, {}, 0.5, kWatson6},
      {"watson-6-bad-start", kWatson, 6, 31, {}, 5, kWatson6},
      {"watson-9-good-start", kWatson, 9, 31, {}, 0.5, kWatson9},
      {"watson-9-bad-start", kWatson, 9, 31, {}, 5, kWatson9},
      {"watson-12-good-start", kWatson, 12, 31, {}, 0.5, kWatson12},
      {"watson-12-bad-start", kWatson, 12, 31, {}, 5, kWatson12},
      {"box-3d", kBox3d, 3, 10, {0, 10, 20}, 1, 0},
      {"jennrich-sampson", kJennrichSampson, 2, 10, {0.3, 0.4}, 1, 124.3621823556148},
      {"brown-dennis-good-start", kBrownDennis, 4, 20, brown_dennis, 1, kBrownDennisLeast},
      {"brown-dennis-bad-start", kBrownDennis, 4, 20, brown_dennis, 10, kBrownDennisLeast},
      {"chebyquad-6", kChebyquad, 6, 6, even_start(6), 1, 0},
      {"chebyquad-7", kChebyquad, 7, 7, even_start(7), 1, 0},
      {"chebyquad-8", kChebyquad, 8, 8, even_start(8), 1, 0.003516873725677},
      {"chebyquad-9", kChebyquad, 9, 9, even_start(9), 1, 0},
      {"chebyquad-10", kChebyquad, 10, 10, even_start(10), 1, 0.00477271369637536},
      {"chebyquad-11", kChebyquad, 11, 11, even_start(11), 1, 0.00279976155186576},
      {"brown-almost-linear", kBrownAlmostLinear, 10, 10, {}, 0.5, 0},
      {"osborne-one", kOsborne1, 5, 33, {0.5, 1.5, 1, 0.01, 0.02}, 1, 0.00005464894697483},
      {"osborne-two-good-start", kOsborne2, 11, 65, osborne2, 1, kOsborne2Least},
      {"osborne-two-bad-start", kOsborne2, 11, 65, osborne2, 10, kOsborne2Least},
      {"bdqrtic-8", kBdqrtic, 8, 8, {}, 1, 10.2389734213174},
      {"bdqrtic-10", kBdqrtic, 10, 12, {}, 1, 18.28116175359353},
      {"bdqrtic-11", kBdqrtic, 11, 14, {}, 1, 22.260591734883817},
      {"bdqrtic-12", kBdqrtic, 12, 16, {}, 1, 26.2727663967939},
      {"cube-5", kCube, 5, 5, {}, 0.5, 0},
      {"cube-6", kCube, 6, 6, {}, 0.5, 0},
      {"cube-8", kCube, 8, 8, {}, 0.5, 0},
      {"mancino-5-good-start", kMancino, 5, 5, mancino_start(5), 1, 0},
      {"mancino-5-bad-start", kMancino, 5, 5, mancino_start(5), 10, 0},
      {"mancino-8", kMancino, 8, 8, mancino_start(8), 1, 0},
      {"mancino-10", kMancino, 10, 10, mancino_start(10), 1, 0},
      {"mancino-12-good-start", kMancino, 12, 12, mancino_start(12), 1, 0},
      {"mancino-12-bad-start", kMancino, 12, 12, mancino_start(12), 10, 0},
      {"heart-eight-good-start", kHeartEight, 8, 8, heart, 1, 0},
      {"heart-eight-bad-start", kHeartEight, 8, 8, heart, 10, 0},
      {"brown-almost-linear-medium", kBrownAlmostLinear, 100, 100, {}, 0.5, 0}};
  return all;
}

struct MoreWild {
  std::string name = "freudenstein-roth-good-start";
};
void fields(MoreWild& o, auto& field) {
  Choices names;
  for (const Case& each : cases()) names.push_back(each.name);
  field("case", o.name, names, "function, number of unknowns and start");
}

ProblemParts make_more_wild(const MoreWild& o, const Draw& draw) {
  const Case& c = *std::ranges::find(cases(), o.name, &Case::name);
  Vector start = Vector::Ones(c.n);
  if (!c.start.empty()) start = Eigen::Map<const Vector>(c.start.data(), c.n);
  constexpr Real kDigits = 5e-7;  // half a unit of the seventh digit, which all best values have
  return {.physics = std::make_unique<JetPhysics<JetFunction>>(c.f, c.n, c.m),
          .start = draw.start(c.factor * start, StartScale::own),
          .start_scale = StartScale::own,
          .target = Vector::Zero(c.m),
          .minimum = c.best / 2,
          .minimum_error = kDigits * c.best / 2,
          .scale = std::numeric_limits<Real>::infinity()};  // accuracies are relative to f₀ − f_L
}

}  // namespace

void register_more_wild(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "more-wild",
       .title = "Cases of Moré and Wild",
       .group = Group::classical,
       .formula = "L = ½Σfᵢ²",
       .source = "Moré, Wild (2009); Moré, Garbow, Hillstrom (1981); Conn et al. (1994)",
       .note =
           "f_L is half of the best published Σfᵢ². For Freudenstein and Roth, f_L is 0, because "
           "the published value belongs to a local minimum.",
       .in_all = false},
      make_more_wild));
}

}  // namespace isoline::problems
