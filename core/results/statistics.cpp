// Medians that keep failures, performance profiles, running times, the bootstrap and tests by
// ranks.
#include "core/results/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/files.h"

namespace isoline::results {
namespace {

// Exact distributions of rank sums, counted out by dynamic programming over doubled midranks, which
// are whole numbers; probabilities instead of counts, so that nothing overflows.

constexpr Real kTwoSided = 1.959963984540054;  // the normal quantile of 0.975

// Twice the midranks: a group of ties shares the mean of its ranks.
std::vector<std::size_t> doubled_ranks(const std::vector<Real>& values) {
  std::vector<std::size_t> order(values.size()), ranks(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    ++last;  // even where a value does not equal itself
    while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
    for (std::size_t i = first; i < last; ++i) ranks[order[i]] = first + last + 1;
  }
  return ranks;
}

// Fisher and Yates.
void shuffle(std::vector<Real>& values, Draws& random) {
  for (std::size_t i = values.size(); i > 1; --i)
    std::swap(values[i - 1], values[drawn_place(random, i)]);
}

std::size_t sum_of(const std::vector<std::size_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::size_t{0});
}

// P(sum of the ranks of n drawn without replacement = s), s = 0 … the greatest sum.
std::vector<Real> rank_sum_distribution(const std::vector<std::size_t>& ranks, std::size_t n) {
  const std::size_t most = sum_of(ranks) + 1;
  std::vector<std::vector<Real>> chance(n + 1, std::vector<Real>(most, 0));
  chance[0][0] = 1;
  for (std::size_t seen = 0; seen < ranks.size(); ++seen)
    for (std::size_t k = std::min(n, seen + 1); k > 0; --k) {
      // C(seen + 1, k) subsets: those with this rank are a share of k / (seen + 1) of them.
      const Real with = Real(k) / Real(seen + 1);
      for (std::size_t s = most; s-- > 0;) {
        const Real taken = s >= ranks[seen] ? chance[k - 1][s - ranks[seen]] : 0;
        chance[k][s] = with * taken + (1 - with) * chance[k][s];
      }
    }
  return chance[n];
}

Real two_sided(const std::vector<Real>& chance, std::size_t sum) {
  const auto at = chance.begin() + static_cast<std::ptrdiff_t>(sum);
  const Real below = std::accumulate(chance.begin(), at + 1, 0.0);
  const Real above = std::accumulate(at, chance.end(), 0.0);
  return std::min(1.0, 2 * std::min(below, above));
}

// For a sum with this mean and variance, in the unit of doubled ranks: continuity is one unit, ½·2.
Real two_sided_normal(Real sum, Real mean, Real variance) {
  if (variance <= 0) return 1;
  const Real z = std::max(0.0, std::abs(sum - mean) - 1) / std::sqrt(variance);
  return std::min(1.0, std::erfc(z / std::sqrt(2.0)));
}

Real sum_of_squares(const std::vector<std::size_t>& values) {
  Real sum = 0;
  for (const std::size_t value : values) sum += Real(value) * Real(value);
  return sum;
}

// How many of the ordered ratios lie outside the interval at each end, plus one; 0: all do.
// P(U ≤ k − 1) ≤ (1 − confidence) / 2.
std::size_t interval_order(std::size_t n, std::size_t m) {
  constexpr Real kTail = (1 - kConfidence) / 2;
  const Real product = Real(n) * Real(m), total = Real(n + m + 1);
  if (n + m > kExact)
    return static_cast<std::size_t>(
        std::max(0.0, product / 2 - kTwoSided * std::sqrt(product * total / 12)));
  std::vector<std::size_t> ranks(n + m);
  std::iota(ranks.begin(), ranks.end(), 1);
  const std::vector<Real> chance = rank_sum_distribution(ranks, n);
  std::size_t k = 0;
  constexpr Real kRounding = 1e-12;  // of sums of probabilities
  Real below = chance[n * (n + 1) / 2];
  while (below <= kTail + kRounding) below += chance[n * (n + 1) / 2 + ++k];
  return k;
}

// P(t ≤ x) with so many degrees of freedom, x > 0: Abramowitz, Stegun (1964), 26.7.3 and 26.7.4.
Real student_share(Real x, std::size_t freedom) {
  const Real n = Real(freedom), angle = std::atan(x / std::sqrt(n)), cosine = std::cos(angle);
  const bool is_odd = freedom % 2 == 1;
  Real term = is_odd ? cosine : 1, sum = freedom == 1 ? 0 : term;
  for (std::size_t j = is_odd ? 3 : 2; j < freedom - 1; j += 2) {
    term *= cosine * cosine * Real(j - 1) / Real(j);
    sum += term;
  }
  const Real two_sides =
      is_odd ? 2 / std::numbers::pi * (angle + std::sin(angle) * sum) : std::sin(angle) * sum;
  return 0.5 + two_sides / 2;
}

// The median of all differences right − left.
Real shift(const std::vector<Real>& left, const std::vector<Real>& right,
           std::vector<Real>& differences) {
  differences.clear();
  for (const Real a : left)
    for (const Real b : right) differences.push_back(b - a);
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

// Adds |shift| between the halves of many splits, times √(the sides' variance over the halves').
void add_shifts(const std::vector<Real>& seconds, Real sides, const std::string& key,
                std::vector<Real>& shifts) {
  constexpr std::size_t kSplits = 200;
  constexpr std::size_t kMostUsed = 40;  // repetitions a split: pairs grow by the square
  std::vector<Real> logs, differences;
  for (const Real value : seconds) logs.push_back(std::log(value));
  const std::size_t used = std::min(logs.size(), kMostUsed), half = used / 2;
  if (half == 0) return;
  const Real halves = 1 / Real(half) + 1 / Real(used - half);
  for (std::size_t split = 0; split < kSplits; ++split) {
    Draws random(fnv1a(key), "report", "halves", split);
    shuffle(logs, random);
    const auto middle = logs.begin() + static_cast<std::ptrdiff_t>(half);
    const auto end = logs.begin() + static_cast<std::ptrdiff_t>(used);
    shifts.push_back(std::abs(shift({logs.begin(), middle}, {middle, end}, differences)) *
                     std::sqrt(sides / halves));
  }
}

}  // namespace

Spread spread_of(std::vector<Real> values) {
  Spread spread;
  spread.n = values.size();
  if (values.empty()) return spread;
  for (Real& value : values)
    if (std::isnan(value)) value = kNever;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  spread.low = values.front();
  spread.high = values.back();
  spread.median = values.size() % 2 == 1 ? values[half] : values[half - 1] / 2 + values[half] / 2;
  spread.unsolved = static_cast<std::size_t>(std::ranges::count(values, kNever));
  return spread;
}

Real median_of(std::vector<Real> values) { return spread_of(std::move(values)).median; }

Real score_of(Real ratio, Real most) {
  return std::max(0.0, std::log2(most) - std::log2(ratio)) / std::log2(most);
}

Real Profile::share(std::size_t solver, Real factor) const {
  const auto& [ratios, problems] = solvers[solver];
  if (problems == 0) return 0;
  const auto within = std::upper_bound(ratios.begin(), ratios.end(), factor) - ratios.begin();
  return static_cast<Real>(within) / static_cast<Real>(problems);
}

std::vector<std::optional<Real>> cost_ratios(const std::vector<std::optional<Real>>& costs) {
  constexpr Real kUnit = 1;
  Real least = kNever;
  for (const std::optional<Real>& cost : costs)
    if (cost && *cost < least) least = *cost;  // false for not-a-number
  std::vector<std::optional<Real>> ratios(costs.size());
  for (std::size_t s = 0; s < costs.size(); ++s)
    if (costs[s])
      ratios[s] = *costs[s] < kNever ? std::max(*costs[s], kUnit) / std::max(least, kUnit) : kNever;
  return ratios;
}

Profile performance_profile(const Costs& costs) {
  Profile profile;
  for (const auto& row : costs) {
    profile.solvers.resize(std::max(profile.solvers.size(), row.size()));
    const auto ratios = cost_ratios(row);
    for (std::size_t s = 0; s < row.size(); ++s) {
      if (!ratios[s]) continue;
      ++profile.solvers[s].problems;
      if (*ratios[s] < kNever) profile.solvers[s].ratios.push_back(*ratios[s]);
    }
  }
  for (ProfileLine& line : profile.solvers) std::sort(line.ratios.begin(), line.ratios.end());
  return profile;
}

// Order statistics of subsets.

// Summed one by one: vectorized sums would depend on where the points lie in memory.
std::pair<Real, Real> log_slope(std::vector<Real> x, std::vector<Real> y) {
  for (std::vector<Real>* values : {&x, &y})
    for (Real& value : *values) value = std::log10(value);
  const auto count = static_cast<Real>(x.size());
  const Real x_mean = std::accumulate(x.begin(), x.end(), 0.0) / count;
  const Real y_mean = std::accumulate(y.begin(), y.end(), 0.0) / count;
  Real spread = 0, shared = 0, squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    spread += (x[i] - x_mean) * (x[i] - x_mean);
    shared += (x[i] - x_mean) * (y[i] - y_mean);
  }
  if (spread == 0) return {std::nan(""), std::nan("")};
  const Real slope = shared / spread;
  for (std::size_t i = 0; i < x.size(); ++i)
    squares += std::pow(y[i] - y_mean - slope * (x[i] - x_mean), 2);
  return {slope, std::sqrt(squares / count)};
}

std::vector<Real> expected_best(std::vector<Real> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  std::vector<Real> best;
  for (std::size_t b = 1; b <= n; ++b) {
    // The chance that the i-th is the greatest of b, from the last one down: b / n, and each
    // further one (i − b) / (i − 1) times the chance of the one above it.
    Real chance = Real(b) / Real(n), sum = 0;
    for (std::size_t i = n; i >= b; --i) {
      sum += chance * values[i - 1];
      if (i > b) chance *= Real(i - b) / Real(i - 1);
    }
    best.push_back(sum);
  }
  return best;
}

// Running times and restarts.

Real expected_running_time(const std::vector<Attempt>& attempts) {
  Real spent = 0, successes = 0;
  for (const Attempt& attempt : attempts) {
    spent += attempt.cost;
    successes += attempt.is_success;
  }
  return successes > 0 ? spent / successes : kNever;
}

std::vector<Real> simulated_restarts(const std::vector<Attempt>& attempts, const std::string& key) {
  if (std::ranges::none_of(attempts, &Attempt::is_success))
    return std::vector<Real>(kDraws, kNever);
  std::vector<Real> costs;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    Draws random(fnv1a(key), "report", "restarts", draw);
    Real cost = 0;
    while (true) {
      const Attempt& attempt = attempts[drawn_place(random, attempts.size())];
      cost += attempt.cost;
      if (attempt.is_success) break;
    }
    costs.push_back(cost);
  }
  std::ranges::sort(costs);
  return costs;
}

// Intervals of medians, means and ratios over resamples.

std::size_t drawn_place(Draws& random, std::size_t count) {
  return static_cast<std::size_t>(random.uniform() * Real(count));
}

void resample(std::size_t count, const DrawStream& from,
              const std::function<void(const Places&)>& use) {
  Places places(count);
  Draws random(from.seed, from.component, from.purpose);
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    if (!from.is_for_all) random.restart(draw);
    for (std::size_t& place : places) place = drawn_place(random, count);
    use(places);
  }
}

Real quantile(const std::vector<Real>& ascending, Real share) {
  const Real place = std::ceil(share * Real(ascending.size()));
  return ascending[static_cast<std::size_t>(std::max(place, 1.0)) - 1];
}

Interval interval_of(std::vector<Real> draws) {
  constexpr Real kTail = 0.025;
  std::ranges::sort(draws);
  return {quantile(draws, kTail), quantile(draws, 1 - kTail)};
}

Band bootstrap_ratio(const std::vector<GroupSum>& groups, const std::string& key) {
  if (groups.empty()) return {};
  const std::size_t size = groups[0].sums.size();
  const auto ratios_of = [&](const Places& places) {
    std::vector<Real> ratios(size, 0);
    Real n = 0;
    for (const std::size_t place : places) {
      for (std::size_t i = 0; i < size; ++i) ratios[i] += groups[place].sums[i];
      n += groups[place].n;
    }
    for (Real& ratio : ratios) ratio = n > 0 ? ratio / n : 0;
    return ratios;
  };
  Places all(groups.size());
  std::iota(all.begin(), all.end(), 0);
  Band band{.value = ratios_of(all), .low = {}, .high = {}};
  std::vector<std::vector<Real>> draws(size);  // by component
  resample(groups.size(), {fnv1a(key), "report", "groups"}, [&](const Places& places) {
    const std::vector<Real> ratios = ratios_of(places);
    for (std::size_t i = 0; i < size; ++i) draws[i].push_back(ratios[i]);
  });
  for (std::vector<Real>& values : draws) {
    const Interval interval = interval_of(std::move(values));
    band.low.push_back(interval.low);
    band.high.push_back(interval.high);
  }
  return band;
}

// Tests by ranks.

Real mann_whitney_p(const std::vector<Real>& a, const std::vector<Real>& b) {
  if (a.empty() || b.empty()) return 1;
  std::vector<Real> all = a;
  all.insert(all.end(), b.begin(), b.end());
  const std::vector<std::size_t> ranks = doubled_ranks(all);
  const std::size_t sum =
      sum_of({ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(a.size())});
  if (all.size() <= kExact) return two_sided(rank_sum_distribution(ranks, a.size()), sum);
  const Real n = Real(a.size()), m = Real(b.size()), total = n + m;
  const Real mean = Real(sum_of(ranks)) / total;
  const Real spread = sum_of_squares(ranks) / total - mean * mean;
  return two_sided_normal(Real(sum), n * mean, spread * n * m / (total - 1));
}

RatioEstimate ratio_estimate(const std::vector<Real>& a, const std::vector<Real>& b) {
  std::vector<Real> logs;
  for (const Real left : a)
    for (const Real right : b) logs.push_back(std::log(right) - std::log(left));
  if (logs.empty()) return {};
  std::ranges::sort(logs);
  const std::size_t k = interval_order(a.size(), b.size());
  RatioEstimate estimate{.ratio = std::exp(median_of(logs))};
  if (k > 0) {
    estimate.low = std::exp(logs[k - 1]);
    estimate.high = std::exp(logs[logs.size() - k]);
  }
  return estimate;
}

// From the greatest p down: min over those from it on of n / rank · p.
std::vector<Real> benjamini_hochberg(const std::vector<Real>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p[i]; });
  std::vector<Real> adjusted(p.size());
  Real least = 1;
  for (std::size_t i = order.size(); i-- > 0;) {
    least = std::min(least, Real(p.size()) / Real(i + 1) * p[order[i]]);
    adjusted[order[i]] = least;
  }
  return adjusted;
}

MedianInterval median_interval(std::vector<Real> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const std::size_t n = values.size();
  // From the k-th of the values to the k-th from their end: it misses the median where fewer than k
  // lie on one side of it, P(Binomial(n, ½) < k) on each.
  constexpr std::size_t kMany = 1000;  // 2⁻ⁿ is no number soon after: the normal law serves
  std::size_t k = 0;
  if (n > kMany) k = static_cast<std::size_t>(Real(n) / 2 - kTwoSided * std::sqrt(Real(n)) / 2);
  Real term = n > kMany ? 1 : std::pow(0.5, Real(n)), misses = term;
  while (misses <= (1 - kConfidence) / 2 && 2 * k < n) {
    ++k;
    term *= Real(n - k + 1) / Real(k);
    misses += term;
  }
  const std::size_t first = std::max<std::size_t>(k, 1) - 1;
  return {median_of(values), values[first], values[n - 1 - first]};
}

// Student's t, and what tests find.

Real deviation_of(const std::vector<Real>& values) {
  if (values.size() < 2) return 0;
  const Real n = Real(values.size());
  const Real mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  Real sum = 0;
  for (const Real value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / (n - 1));
}

Real student_quantile(Real share, std::size_t freedom) {
  Real low = 0, high = 1;
  while (student_share(high, freedom) < share) high *= 2;
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const Real middle = (low + high) / 2;
    (student_share(middle, freedom) < share ? low : high) = middle;
  }
  return high;
}

Real chi_square_tail(Real value, std::size_t freedom) {
  const Real half = std::max<Real>(value, std::numeric_limits<Real>::min()) / 2;
  const bool is_odd = freedom % 2 == 1;
  Real tail = is_odd ? std::erfc(std::sqrt(half)) : 0;
  for (std::size_t k = 0; k < freedom / 2; ++k) {
    const Real power = Real(k) + (is_odd ? 0.5 : 0);
    tail += std::exp(power * std::log(half) - half - std::lgamma(power + 1));
  }
  return std::min<Real>(tail, 1);
}

Real detectable_mean(Real deviation, std::size_t n) {
  constexpr Real kBelow = 0.975, kPower = 0.8;
  if (n < kFewestForInterval) return kNever;
  const Real quantiles = student_quantile(kBelow, n - 1) + student_quantile(kPower, n - 1);
  return (1 + 2 / Real(n - 3)) * quantiles * deviation / std::sqrt(Real(n));
}

Interval prediction_interval(const std::vector<Real>& values) {
  if (values.size() < 2) return {.low = -kNever, .high = kNever};
  const Real n = Real(values.size());
  const Real mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  const Real half =
      student_quantile(0.975, values.size() - 1) * deviation_of(values) * std::sqrt(1 + 1 / n);
  return {mean - half, mean + half};
}

VarianceComponents variance_components(const std::vector<std::vector<Real>>& values) {
  const Real I = Real(values.size()), J = Real(values[0].size());
  std::vector<Real> first(values.size(), 0), second(values[0].size(), 0);  // means
  for (std::size_t i = 0; i < first.size(); ++i)
    for (std::size_t j = 0; j < second.size(); ++j) {
      first[i] += values[i][j] / J;
      second[j] += values[i][j] / I;
    }
  const Real mean = std::accumulate(first.begin(), first.end(), 0.0) / I;
  Real rest = 0;
  for (std::size_t i = 0; i < first.size(); ++i)
    for (std::size_t j = 0; j < second.size(); ++j)
      rest += std::pow(values[i][j] - first[i] - second[j] + mean, 2) / ((I - 1) * (J - 1));
  return {std::max(0.0, std::pow(deviation_of(first), 2) - rest / J),
          std::max(0.0, std::pow(deviation_of(second), 2) - rest / I), rest};
}

// Verdicts on times: the noise that the repetitions show.

Real split_noise(const std::vector<TimedCell>& cells) {
  constexpr Real kWithin = 0.95;
  std::vector<Real> shifts;
  for (const TimedCell& cell : cells) {
    const Real sides = 1 / Real(cell.before.size()) + 1 / Real(cell.after.size());
    add_shifts(cell.before, sides, cell.key, shifts);
    add_shifts(cell.after, sides, cell.key, shifts);
  }
  if (shifts.empty()) return kNever;
  const auto at = shifts.begin() + static_cast<std::ptrdiff_t>(kWithin * Real(shifts.size()));
  std::nth_element(shifts.begin(), at, shifts.end());
  return std::expm1(*at);
}

std::vector<TimeVerdict> judge_times(const std::vector<TimedCell>& cells, Real least_noise) {
  std::vector<TimeVerdict> verdicts;
  std::vector<Real> p;
  const Real noise = std::max(least_noise, split_noise(cells));
  for (const TimedCell& cell : cells) {
    verdicts.push_back({.key = cell.key,
                        .title = cell.title,
                        .n_before = cell.before.size(),
                        .n_after = cell.after.size(),
                        .ratio = ratio_estimate(cell.before, cell.after),
                        .p = mann_whitney_p(cell.before, cell.after),
                        .noise = noise});
    p.push_back(verdicts.back().p);
  }
  const std::vector<Real> adjusted = benjamini_hochberg(p);
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    TimeVerdict& verdict = verdicts[i];
    verdict.adjusted = adjusted[i];
    if (verdict.adjusted > kFalseDiscoveries) continue;
    if (verdict.ratio.low > 1 + verdict.noise) verdict.change = 1;
    if (verdict.ratio.high < 1 / (1 + verdict.noise)) verdict.change = -1;
  }
  std::ranges::stable_sort(verdicts, [](const TimeVerdict& a, const TimeVerdict& b) {
    return std::pair(-a.change, -a.ratio.ratio) < std::pair(-b.change, -b.ratio.ratio);
  });
  return verdicts;
}

namespace {

// Σ over methods of (Σ over blocks of its rank)², ranks less their mean.
Real squares_of_sums(const std::vector<std::vector<Real>>& ranks) {
  Real total = 0;
  for (std::size_t j = 0; j < ranks[0].size(); ++j) {
    Real sum = 0;
    for (const auto& block : ranks) sum += block[j];
    total += sum * sum;
  }
  return total;
}

// The orders of the blocks from `block` on, and those of them that reach `far`. The first block
// keeps its own: permuting all blocks in the same way changes nothing.
void count_orders(std::vector<std::vector<Real>>& ranks, std::size_t block, Real far, Real& all,
                  Real& reached) {
  if (block == ranks.size()) {
    ++all;
    reached += squares_of_sums(ranks) >= far;
    return;
  }
  std::ranges::sort(ranks[block]);
  do count_orders(ranks, block + 1, far, all, reached);
  while (std::ranges::next_permutation(ranks[block]).found);
}

}  // namespace

Real friedman_p(const std::vector<std::vector<Real>>& values) {
  constexpr Real kMostOrders = 1 << 16;
  constexpr std::size_t kPermutations = 10'000;
  if (values.size() < 2 || values[0].size() < 2) return 1;
  std::vector<std::vector<Real>> ranks;  // twice the mid-ranks, less their mean
  Real orders = 1;
  for (const auto& block : values) {
    std::vector<Real>& row = ranks.emplace_back();
    for (const std::size_t rank : doubled_ranks(block))
      row.push_back(Real(rank) - Real(block.size() + 1));
    if (ranks.size() > 1) orders *= std::tgamma(Real(block.size()) + 1);
  }
  const Real far = squares_of_sums(ranks);
  if (orders <= kMostOrders) {
    Real all = 0, reached = 0;
    count_orders(ranks, 1, far, all, reached);
    return reached / all;
  }
  Draws random(0, "report", "permutations");
  std::size_t reached = 1;
  for (std::size_t draw = 1; draw < kPermutations; ++draw) {
    for (std::size_t block = 1; block < ranks.size(); ++block) shuffle(ranks[block], random);
    reached += squares_of_sums(ranks) >= far;
  }
  return Real(reached) / Real(kPermutations);
}

Real rank_correlation(const std::vector<Real>& a, const std::vector<Real>& b) {
  const std::vector<std::size_t> ranks_a = doubled_ranks(a), ranks_b = doubled_ranks(b);
  const Real mean = Real(a.size() + 1);
  Real product = 0, square_a = 0, square_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Real from_a = Real(ranks_a[i]) - mean, from_b = Real(ranks_b[i]) - mean;
    product += from_a * from_b;
    square_a += from_a * from_a;
    square_b += from_b * from_b;
  }
  return product / std::sqrt(square_a * square_b);
}

}  // namespace isoline::results
