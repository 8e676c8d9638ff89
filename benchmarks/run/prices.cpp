// Measures prices: a forward solve at a fresh point and one call of the oracle after it, each timed
// by itself, over and over; a round is many such pairs on work space of its own. Its price is the
// ratio of the two medians, so that neither a drift of the machine nor what others take of it
// counts, and nothing is subtracted. The call includes all that it has to prepare at a fresh point.
#include "benchmarks/run/prices.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "benchmarks/plan/build_parts.h"
#include "core/clock.h"
#include "core/records/provenance.h"

namespace isoline::benchmarks {

using networks::LayerFactor;
using networks::LayerMoments;
using problems::Point;
namespace {

constexpr double kRoundSeconds = 2e-4;  // of calls, so that a round is many of the short ones
constexpr double kOracleSeconds = 1e-2, kLongOracleSeconds = 0.15, kMatrixSeconds = 1e-2;
constexpr double kProblemSeconds = 1;
constexpr double kClockSeconds = 2e-5;  // a call this long can afford the clock of the processor
constexpr std::size_t kMostPairs = 1000, kMostRounds = 31, kFewRounds = 3;
constexpr Real kWidest = 4;  // a range over this factor, or down to nothing, says too little
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
  std::vector<LayerMoments> moments;
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
    case Oracle::layer_moments:
      return problem.layer_moments(room.w, room.moments, room.gradient, at);
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

// Of the processor; where another process computes, of the clock on the wall.
double seconds_by(bool is_elsewhere) {
  return is_elsewhere ? 1e-9 * static_cast<double>(monotonic_nanoseconds()) : processor_seconds();
}

// What one call takes: of the processor, where it is long enough to be interrupted; else by its
// time-stamp counter, which costs little beside a microsecond.
double seconds_of(const Problem& problem, double expected, const std::function<void()>& call) {
  if (expected > kClockSeconds && !problem.is_elsewhere()) {
    const double begin = processor_seconds();
    call();
    return processor_seconds() - begin;
  }
  const std::uint64_t begin = ticks();
  call();
  return static_cast<double>(ticks() - begin) * seconds_per_tick();
}

Real at_share(std::vector<Real>& values, Real share) {
  const auto at = std::lround(share * static_cast<Real>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

// Of one oracle: what is expected of it and of the forward solve before it, in seconds.
struct Question {
  Oracle oracle;
  double forward, expected;
};

struct Rounds {
  std::vector<Real> forward_seconds, ratios;
  std::size_t calls = 0;
};

// On work space of its own: where arrays happen to lie is part of the range over rounds.
void add_round(const Problem& problem, const Question& of, Rounds& rounds) {
  Point at;
  Room room(problem);
  const double wanted = kRoundSeconds / std::max(of.forward, of.expected);
  const auto pairs = std::clamp(static_cast<std::size_t>(wanted), std::size_t{1}, kMostPairs);
  std::vector<Real> before, asked;
  for (std::size_t i = 0; i <= pairs; ++i) {
    const double solve =
        seconds_of(problem, of.forward, [&] { problem.forward(problem.start(), at); });
    const double call =
        seconds_of(problem, of.expected, [&] { ask(of.oracle, problem, at, room); });
    if (i == 0) continue;  // the first allocates
    before.push_back(solve);
    asked.push_back(call);
  }
  const Real forward = std::max(at_share(before, 0.5), 1e-9);
  rounds.calls += pairs;
  rounds.forward_seconds.push_back(forward);
  rounds.ratios.push_back(of.oracle == Oracle::forward ? 1 : at_share(asked, 0.5) / forward);
}

Rounds rounds_of(const Problem& problem, const Question& of) {
  Rounds rounds;
  const double begin = seconds_by(problem.is_elsewhere());
  while (rounds.ratios.size() < kMostRounds) {
    add_round(problem, of, rounds);
    const double spent = seconds_by(problem.is_elsewhere()) - begin;
    if (spent > kLongOracleSeconds) break;
    if (spent > kOracleSeconds && rounds.ratios.size() >= kFewRounds) break;
  }
  return rounds;
}

MeasuredPrice price_of(std::string_view name, std::int64_t declared, double forward,
                       Rounds& rounds) {
  MeasuredPrice price{.oracle = std::string(name),
                      .declared = declared,
                      .price = at_share(rounds.ratios, 0.5),
                      .low = at_share(rounds.ratios, kTail),
                      .high = at_share(rounds.ratios, 1 - kTail),
                      .rounds = static_cast<std::int64_t>(rounds.ratios.size()),
                      .calls = static_cast<std::int64_t>(rounds.calls)};
  price.resolved = is_resolved(price, forward);
  return price;
}

// The network alone, as `isoline infer` applies it, to the samples of a batch at once: what one of
// them takes. No forward solve goes before it, since none is needed.
MeasuredPrice inference_price(const Problem& problem, double forward) {
  const problems::Network& network = problem.network();
  const Matrix& input = problem.batch().input;
  const Vector& theta = problem.start();
  Rounds rounds;
  const double begin = processor_seconds();
  while (rounds.ratios.size() < kMostRounds) {
    Workspace workspace;
    Matrix x(problem.inputs(), problem.samples());
    const Vector statistics = network.statistics(theta, input, workspace);
    const auto infer = [&] { network.infer(theta, statistics, input, x, workspace); };
    seconds_of(problem, 1, infer);  // allocates
    const double once = seconds_of(problem, 1, infer);
    const auto calls = static_cast<std::size_t>(
        std::clamp(kRoundSeconds / std::max(once, 1e-9), 1.0, static_cast<double>(kMostPairs)));
    std::vector<Real> seconds;
    for (std::size_t i = 0; i < calls; ++i) seconds.push_back(seconds_of(problem, once, infer));
    rounds.calls += calls;
    rounds.ratios.push_back(std::max(at_share(seconds, 0.5), 1e-9) / forward /
                            static_cast<Real>(problem.samples()));
    if (processor_seconds() - begin > kLongOracleSeconds && rounds.ratios.size() >= kFewRounds)
      break;
  }
  return price_of(kInference, 0, forward, rounds);
}

}  // namespace

bool is_resolved(const MeasuredPrice& price, double forward_seconds) {
  return forward_seconds >= kLeastForwardSeconds && price.low > 0 &&
         price.high <= kWidest * price.low;
}

MeasuredPrices measure_prices(const Problem& problem, const std::string& build) {
  MeasuredPrices measured{.build = build, .processor = this_build()->processor, .oracles = {}};
  Point at;
  const std::function<void()> solve = [&] { problem.forward(problem.start(), at); };
  const double begin = seconds_by(problem.is_elsewhere());
  seconds_of(problem, 1, solve);  // allocates
  const double once = std::max(seconds_of(problem, 1, solve), 1e-9);
  Rounds alone = rounds_of(problem, {Oracle::forward, once, once});
  measured.forward_seconds = at_share(alone.forward_seconds, 0.5);
  const OracleCounts declared = problem.prices();
  const double forward = measured.forward_seconds;
  measured.oracles.push_back(price_of(name_of(Oracle::forward), 1, forward, alone));
  if (problem.is_learned()) measured.oracles.push_back(inference_price(problem, forward));
  for (const Oracle oracle : measured_ones(problem.offers())) {
    if (seconds_by(problem.is_elsewhere()) - begin > kProblemSeconds) break;
    const auto kind = static_cast<std::size_t>(oracle);
    const double expected = forward * static_cast<double>(declared[kind]);
    if (row_of(oracle).is_dense_matrix && expected > kMatrixSeconds) continue;
    Rounds rounds = rounds_of(problem, {oracle, forward, expected});
    measured.oracles.push_back(price_of(name_of(oracle), declared[kind], forward, rounds));
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
