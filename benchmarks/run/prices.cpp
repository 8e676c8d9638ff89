// Measures prices: rounds of forward solves alone and of forward solves each followed by one call
// of the oracle, side by side, so that a drift of the machine falls on both. What the call adds is
// its price: the first at a fresh point, with all that it has to prepare.
#include "benchmarks/run/prices.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "benchmarks/plan/build_parts.h"
#include "core/clock.h"
#include "core/records/provenance.h"

namespace isoline::benchmarks {

using networks::LayerFactor;
using problems::Point;
namespace {

constexpr double kRoundSeconds = 5e-5;  // of forward solves: two hundred readings of the clock
constexpr double kOracleSeconds = 5e-3, kLongOracleSeconds = 5e-2, kMatrixSeconds = 1e-2;
// Of one problem.
constexpr double kProblemSeconds = 1, kSlowSeconds = 1e-2;
constexpr std::size_t kMostRounds = 31, kFewRounds = 3;
constexpr Real kTail = 0.1;  // on either side of the middle 80 %

// Room for what goes into the oracles of a problem and comes out of them.
struct Room {
  explicit Room(const Problem& problem)
      : w(Matrix::Ones(problem.outputs(), problem.samples())),
        u(Matrix::Ones(problem.inputs(), problem.samples())),
        v(Vector::Ones(problem.unknowns())),
        y(w),
        x(u),
        gradient(v) {}

  Matrix w, u;  // (m, B), (k, B)
  Vector v;     // (n)
  Matrix y, x;  // (m, B), (k, B)
  Vector gradient;
  Matrix J, H, dy_dx, bent;
  std::vector<LayerFactor> factors;
};

void ask(Oracle oracle, const Problem& problem, Point& at, Room& room) {
  switch (oracle) {
    case Oracle::pullback:
      return problem.pullback(room.w, room.gradient, at);
    case Oracle::pushforward:
      return problem.pushforward(room.v, room.y, at);
    case Oracle::jacobian:
      return problem.jacobian(room.J, at);
    case Oracle::hessian:
      return problem.hessian(room.H, at);
    case Oracle::curvature:
      room.bent.resize(problem.inputs(), problem.inputs() * problem.samples());
      return problem.curvature(room.w, room.bent, at);
    case Oracle::sensitivity:
      return problem.sensitivity(room.dy_dx, at);
    case Oracle::hessian_product:
      return problem.hessian_product(room.v, room.gradient, at);
    case Oracle::inverse:
      problem.local_inverse(problem.target(), room.x, at);
      return;
    case Oracle::network:
      return problem.network_pullback(room.u, room.gradient, at);
    case Oracle::layer_factors:
      return problem.layer_factors(room.w, room.factors, at);
    case Oracle::forward:
    case Oracle::truth:  // nothing is computed
      return;
  }
}

// All that the problem offers and that is computed: products before the dense matrices, which
// large networks take up the time with.
std::vector<Oracle> measured_ones(OracleSet offered) {
  std::vector<Oracle> products, matrices;
  for (const OracleRow& row : kOracleTable) {
    const bool is_computed = row.kind != Oracle::forward && row.kind != Oracle::truth;
    if (!is_computed || !offered.contains(row.kind)) continue;
    (row.is_dense_matrix ? matrices : products).push_back(row.kind);
  }
  products.insert(products.end(), matrices.begin(), matrices.end());
  return products;
}

// Of the processor: what others take of a busy machine does not count.
double seconds_of(std::size_t times, const std::function<void()>& call) {
  const double begin = processor_seconds();
  for (std::size_t i = 0; i < times; ++i) call();
  return std::max(processor_seconds() - begin, 1e-9);
}

Real at_share(const std::vector<Real>& ascending, Real share) {
  return ascending[static_cast<std::size_t>(share * static_cast<Real>(ascending.size() - 1) + 0.5)];
}

// Ratios of single rounds, ascending.
std::vector<Real> rounds_of(std::size_t calls, const std::function<void()>& forward,
                            const std::function<void()>& both) {
  std::vector<Real> ratios;
  for (double spent = 0; ratios.size() < kMostRounds;) {
    const double alone = seconds_of(calls, forward), together = seconds_of(calls, both);
    ratios.push_back(std::max(0.0, together / alone - 1));
    spent += alone + together;
    if (spent > kLongOracleSeconds) break;
    if (spent > kOracleSeconds && ratios.size() >= kFewRounds) break;
  }
  std::ranges::sort(ratios);
  return ratios;
}

MeasuredPrice price_of(Oracle oracle, std::int64_t declared, std::size_t calls,
                       const std::vector<Real>& ratios) {
  return {.oracle = std::string(name_of(oracle)),
          .declared = declared,
          .price = at_share(ratios, 0.5),
          .low = at_share(ratios, kTail),
          .high = at_share(ratios, 1 - kTail),
          .rounds = static_cast<std::int64_t>(ratios.size()),
          .calls = static_cast<std::int64_t>(ratios.size() * calls)};
}

}  // namespace

MeasuredPrices measure_prices(const Problem& problem, const std::string& build) {
  MeasuredPrices measured{.build = build, .processor = this_build()->processor, .oracles = {}};
  Point at;
  Room room(problem);
  const std::function<void()> forward = [&] { problem.forward(problem.start(), at); };
  const double begin = processor_seconds(), cold = seconds_of(1, forward);  // allocates
  const auto few = static_cast<std::size_t>(std::clamp(1e-3 / cold, 1.0, 100.0));
  const double once = seconds_of(few, forward) / static_cast<double>(few);
  const auto calls = static_cast<std::size_t>(std::ceil(kRoundSeconds / once));
  std::vector<Real> seconds;
  for (double spent = 0; seconds.size() < kMostRounds && spent < kOracleSeconds;
       spent += seconds.back() * static_cast<double>(calls))
    seconds.push_back(seconds_of(calls, forward) / static_cast<double>(calls));
  std::ranges::sort(seconds);
  measured.forward_seconds = at_share(seconds, 0.5);
  measured.oracles.push_back(
      price_of(Oracle::forward, 1, calls, std::vector<Real>(seconds.size(), 1)));
  const OracleCounts declared = problem.prices();
  for (const Oracle oracle : measured_ones(problem.offers())) {
    if (processor_seconds() - begin > kProblemSeconds) break;
    const auto kind = static_cast<std::size_t>(oracle);
    const double expected = measured.forward_seconds * static_cast<double>(declared[kind]);
    if (row_of(oracle).is_dense_matrix && expected > kMatrixSeconds) continue;
    const std::function<void()> both = [&] {
      problem.forward(problem.start(), at);
      ask(oracle, problem, at, room);
    };
    if (once < kSlowSeconds) both();  // allocates
    measured.oracles.push_back(
        price_of(oracle, declared[kind], calls, rounds_of(calls, forward, both)));
  }
  return measured;
}

std::string prices_build(const Component& problem) {
  return build_digest({.problem = problem, .optimizer = {}});
}

bool are_ours(const std::optional<MeasuredPrices>& prices, const std::string& build) {
  return prices && prices->build == build && prices->processor == this_build()->processor;
}

}  // namespace isoline::benchmarks
