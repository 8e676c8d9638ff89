// Scores, sign-flip tests, the confidence set of the best, and the dependence of the first rank on
// chance and on choices.
#include "core/results/decisions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "core/array.h"
#include "core/draws.h"
#include "core/results/contrasts.h"
#include "core/results/statistics.h"
#include "core/seeds.h"
#include "core/threads.h"

namespace isoline::results {
namespace {

using Row = std::vector<Real>;

constexpr Real kRounding = 1e-9;  // of sums, relative
constexpr Real kNone = std::numeric_limits<Real>::quiet_NaN();

// Settings of one family, in the order in which families come first.
std::vector<std::vector<std::size_t>> by_family(const std::vector<std::string>& families) {
  std::map<std::string, std::size_t> places;
  std::vector<std::vector<std::size_t>> all;
  for (std::size_t p = 0; p < families.size(); ++p) {
    const auto [place, is_new] = places.try_emplace(families[p], all.size());
    if (is_new) all.emplace_back();
    all[place->second].push_back(p);
  }
  return all;
}

bool are_tied(Real a, Real b) { return std::abs(a - b) <= kRounding; }

// Those with the greatest score; none where all are 0.
std::vector<std::size_t> firsts(const Row& scores) {
  std::vector<std::size_t> all;
  const Real most = scores.empty() ? 0 : std::ranges::max(scores);
  for (std::size_t s = 0; s < scores.size() && most > 0; ++s)
    if (are_tied(scores[s], most)) all.push_back(s);
  return all;
}

// --- flips of signs

// Sums of the scores of each family, whose signs flip: sums[g][s].
struct Flips {
  std::vector<Row> sums;
  Row total;               // over families
  std::vector<Row> scale;  // [s][t] 1 / √(Σ_g d_g²); 0 where two never differ

  explicit Flips(std::vector<Row> given) : sums(std::move(given)), total(sums[0].size(), 0) {
    const std::size_t k = total.size();
    scale.assign(k, Row(k, 0));
    for (const Row& row : sums)
      for (std::size_t s = 0; s < k; ++s) {
        total[s] += row[s];
        for (std::size_t t = 0; t < k; ++t) scale[s][t] += (row[s] - row[t]) * (row[s] - row[t]);
      }
    for (Row& row : scale)
      for (Real& value : row) value = value > 0 ? 1 / std::sqrt(value) : 0;
  }

  Real size(std::size_t s, std::size_t t) const { return (total[t] - total[s]) * scale[s][t]; }

  // use(sums under a flip) for each flip; the first flip is the identity. A flip of all signs
  // leaves every |u| unchanged: the last family keeps its sign where flips are enumerated.
  template <class Use>
  std::size_t each(const Use& use, std::size_t exact_families, std::size_t drawn_flips) const {
    const std::size_t families = sums.size();
    Row flipped = total;
    const auto flip = [&](std::size_t g, bool is_minus) {
      const Real sign = is_minus ? -2 : 2;
      for (std::size_t s = 0; s < flipped.size(); ++s) flipped[s] += sign * sums[g][s];
    };
    if (families <= exact_families) {
      const std::size_t count = std::size_t{1} << (families - 1);
      for (std::size_t i = 0, code = 0; i < count; ++i) {  // Gray's code: one sign at a time
        const std::size_t next = i ^ (i >> 1U);
        if (next != code) {
          std::size_t g = 0;
          while (((next ^ code) >> g & 1U) == 0) ++g;
          flip(g, (next >> g & 1U) == 1);
          code = next;
        }
        use(flipped);
      }
      return count;
    }
    use(flipped);
    Draws random(0, "report", "joint signs");
    for (std::size_t i = 1; i < drawn_flips; ++i) {
      flipped.assign(total.size(), 0);
      for (const Row& row : sums) {
        const Real sign = random.uniform() < 0.5 ? -1 : 1;
        for (std::size_t s = 0; s < flipped.size(); ++s) flipped[s] += sign * row[s];
      }
      use(flipped);
    }
    return drawn_flips;
  }
};

// The order in which methods leave the confidence set, whatever the level, and the greatest u at
// each step. The last one never leaves.
struct Leaving {
  std::vector<std::size_t> order;
  Row sizes;
};
Leaving leaving_order(const Flips& flips) {
  std::vector<std::size_t> left(flips.total.size());
  std::iota(left.begin(), left.end(), 0);
  Leaving leaving;
  while (left.size() > 1) {
    Real most = -kNever;
    std::size_t worst = 0;
    for (std::size_t i = 0; i < left.size(); ++i)
      for (const std::size_t t : left)
        if (t != left[i] && flips.size(left[i], t) > most) {
          most = flips.size(left[i], t);
          worst = i;
        }
    leaving.order.push_back(left[worst]);
    leaving.sizes.push_back(most);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(worst));
  }
  leaving.order.push_back(left[0]);
  return leaving;
}

// --- the bootstrap

// The results on one setting, those of an instance side by side.
struct Crossed {
  std::vector<std::size_t> begins{0};  // [instance], among all starts; and their number
  Row costs;                           // [start][method]; NaN where no such run exists
};

Crossed by_instance(const std::vector<Repetition>& repetitions) {
  std::map<std::uint64_t, std::vector<const Repetition*>> instances;
  for (const Repetition& each : repetitions) instances[instance_of(each.seed)].push_back(&each);
  Crossed all;
  for (const auto& [instance, starts] : instances) {
    all.begins.push_back(all.begins.back() + starts.size());
    for (const Repetition* each : starts)
      for (const std::optional<Real>& cost : each->costs) all.costs.push_back(cost.value_or(kNone));
  }
  return all;
}

// The results of each method on one setting over resampled instances, and within them starts. An
// empty resample gets the median of all runs.
std::vector<std::optional<Real>> drawn_costs(const std::vector<std::optional<Real>>& costs,
                                             const Crossed& all, Draws& random) {
  std::vector<Row> values(costs.size());
  const std::size_t instances = all.begins.size() - 1;
  for (std::size_t i = 0; i < instances; ++i) {
    const std::size_t instance = drawn_place(random, instances), begin = all.begins[instance],
                      starts = all.begins[instance + 1] - begin;
    for (std::size_t j = 0; j < starts; ++j) {
      const Real* const drawn = &all.costs[(begin + drawn_place(random, starts)) * costs.size()];
      for (std::size_t s = 0; s < costs.size(); ++s)
        if (!std::isnan(drawn[s])) values[s].push_back(drawn[s]);
    }
  }
  std::vector<std::optional<Real>> medians = costs;
  for (std::size_t s = 0; s < costs.size(); ++s)
    if (costs[s] && !values[s].empty()) medians[s] = median_of(std::move(values[s]));
  return medians;
}

// --- the decision, part by part

class Decider {
 public:
  explicit Decider(const Evidence& evidence)
      : evidence_(evidence), families_(by_family(evidence.families)) {
    const std::size_t all = evidence.costs.empty() ? 0 : evidence.costs[0].size();
    for (std::size_t s = 0; s < all; ++s) {
      const auto run = std::ranges::count_if(evidence.costs,
                                             [&](const auto& row) { return row[s].has_value(); });
      if (run == static_cast<std::ptrdiff_t>(evidence.costs.size()))
        methods_.push_back(s);
      else if (run > 0)
        unranked_.push_back(s);
    }
    scores_ = family_scores(evidence.costs, evidence.families, methods_);
    means_ = mean_scores(scores_);
  }

  std::vector<Place> places() const {
    std::vector<Place> out;
    if (firsts(means_).empty()) return out;
    std::vector<std::size_t> order(methods_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
      return means_[a] > means_[b] && !are_tied(means_[a], means_[b]);
    });
    FlipLevels levels = flip_levels(scores_);
    const auto is_equal = [&](std::size_t s) {  // for a user
      return means_[order[0]] - means_[s] <= score_margin();
    };
    levels.is_lead = levels.is_lead && !is_equal(order[1]);
    for (const std::size_t s : order) {
      Row own;
      for (const Row& family : scores_) own.push_back(family[s]);
      Place place{.method = methods_[s],
                  .score = means_[s],
                  .interval = score_interval(own),
                  .p = levels.pairs[order[0]][s],
                  .adjusted = levels.leaves[s],
                  .is_in_group = levels.is_in_group(s) || is_equal(s),
                  .ratio = work_ratio(evidence_.costs, evidence_.families, methods_[s],
                                      methods_[order[0]])};
      for (const auto& row : evidence_.costs) {
        Real least = kNever;
        for (const std::size_t t : methods_) least = std::min(least, *row[t]);
        place.solved += *row[place.method] < kNever;
        place.wins += *row[place.method] < kNever && *row[place.method] == least;
      }
      out.push_back(place);
    }
    return out;
  }

  std::optional<Decision> decision() const {
    Decision out{.places = places()};
    if (out.places.empty()) return std::nullopt;
    out.unranked = unranked_;
    out.settings = evidence_.costs.size();
    out.families = families_.size();
    out.least_p = std::exp2(1 - Real(families_.size()));
    out.is_range = families_.size() < kFewestForInterval;
    out.tied = firsts(means_).size();
    out.is_lead = out.places.size() > 1 && out.group().size() == 1;
    fill_contrasts(out);
    fill_shares(out);
    fill_choices(out);
    return out;
  }

 private:
  // Between the first and each other method, and between all.
  void fill_contrasts(Decision& out) const {
    const auto column_of = [&](const Place& place) {
      return std::ranges::find(methods_, place.method) - methods_.begin();
    };
    const auto first = column_of(out.places[0]);
    Row detectable;
    for (std::size_t i = 1; i < out.places.size(); ++i) {
      const auto other = column_of(out.places[i]);
      Row differences;
      for (const Row& family : scores_) differences.push_back(family[first] - family[other]);
      detectable.push_back(detectable_mean(deviation_of(differences), differences.size()));
    }
    out.detectable = detectable.empty() ? kNever : median_of(std::move(detectable));
    out.friedman = friedman_p(scores_);
  }

  // Families, within them instances, within these starts.
  void fill_shares(Decision& out) const {
    std::vector<Crossed> crossed;  // [setting]
    for (const auto& repetitions : evidence_.repetitions)
      crossed.push_back(by_instance(repetitions));
    std::vector<std::vector<std::size_t>> best(kDraws);
    share(kDraws, [&](std::size_t draw) {
      Draws random(0, "report", "hierarchy", draw);
      Costs costs;
      std::vector<std::string> families;  // one that is drawn twice is two
      for (std::size_t g = 0; g < families_.size(); ++g)
        for (const std::size_t p : families_[drawn_place(random, families_.size())]) {
          costs.push_back(crossed.empty() || evidence_.repetitions[p].size() < 2
                              ? evidence_.costs[p]
                              : drawn_costs(evidence_.costs[p], crossed[p], random));
          families.push_back(std::to_string(g));
        }
      best[draw] = firsts(mean_scores(family_scores(costs, families, methods_)));
    });
    Row first(methods_.size(), 0);
    for (const auto& those : best)
      for (const std::size_t s : those) first[s] += 1 / Real(those.size());
    for (std::size_t s = 0; s < methods_.size(); ++s)
      std::ranges::find(out.places, methods_[s], &Place::method)->share_first =
          first[s] / Real(kDraws);
  }

  void add_choice(Decision& out, Varied varied, std::string value, const Costs& costs,
                  const std::vector<std::string>& families, Real end = kProfileEnd) const {
    Choice choice{.varied = varied, .value = std::move(value), .first = {}};
    const std::vector<Row> scores = family_scores(costs, families, methods_, end);
    for (const std::size_t s : firsts(mean_scores(scores))) choice.first.push_back(methods_[s]);
    choice.is_kept = std::ranges::find(choice.first, out.places[0].method) != choice.first.end();
    if (!choice.first.empty()) {
      // The flips may be few for a size that is compared with others.
      constexpr std::size_t kExact = 12, kDrawn = 4096;
      const FlipLevels levels = flip_levels(scores, kExact, kDrawn);
      for (std::size_t s = 0; s < methods_.size(); ++s) choice.group += levels.is_in_group(s);
    }
    out.choices.push_back(std::move(choice));
  }

  // Only the settings that is_kept(setting) keeps.
  template <class Kept>
  void add_subset(Decision& out, Varied varied, std::string value, Kept is_kept) const {
    Costs costs;
    std::vector<std::string> families;
    for (std::size_t p = 0; p < evidence_.costs.size(); ++p) {
      if (!is_kept(p)) continue;
      costs.push_back(evidence_.costs[p]);
      families.push_back(evidence_.families[p]);
    }
    if (!costs.empty()) add_choice(out, varied, std::move(value), costs, families);
  }

  void fill_choices(Decision& out) const {
    const auto& families = evidence_.families;
    for (const int end : {16, 256})
      add_choice(out, Varied::profile_end, std::to_string(end), evidence_.costs, families, end);
    for (const OtherCosts& other : evidence_.others)
      add_choice(out, other.varied, other.value, other.costs, families);
    for (const auto& left_out : families_) {
      if (families_.size() < 2) break;
      const std::string& name = families[left_out[0]];
      add_subset(out, Varied::family, name, [&](std::size_t p) { return families[p] != name; });
    }
    const auto& linear = evidence_.linear;
    if (std::ranges::find(linear, true) != linear.end())
      add_subset(out, Varied::linear, "", [&](std::size_t p) { return !linear[p]; });
    std::set<std::uint64_t> seeds;
    for (const auto& repetitions : evidence_.repetitions)
      for (const Repetition& each : repetitions) seeds.insert(each.seed);
    for (const std::uint64_t seed : seeds)
      if (seeds.size() > 1)
        add_choice(out, Varied::seed, seed_text(seed), costs_of_seed(seed), families);
  }

  Costs costs_of_seed(std::uint64_t seed) const {
    Costs costs = evidence_.costs;
    for (std::size_t p = 0; p < costs.size(); ++p)
      for (const Repetition& each : evidence_.repetitions[p])
        for (std::size_t s = 0; s < costs[p].size(); ++s)
          if (each.seed == seed && costs[p][s] && each.costs[s]) costs[p][s] = each.costs[s];
    return costs;
  }

  const Evidence& evidence_;
  std::vector<std::vector<std::size_t>> families_;
  std::vector<std::size_t> methods_, unranked_;  // that are ranked, and that ran on some settings
  std::vector<Row> scores_;                      // [family][place in methods_]
  Row means_;
};

}  // namespace

std::vector<Row> family_scores(const Costs& costs, const std::vector<std::string>& families,
                               const std::vector<std::size_t>& methods, Real end) {
  std::vector<Row> scores;
  for (const auto& settings : by_family(families)) {
    Row& means = scores.emplace_back(methods.size(), 0);
    for (const std::size_t p : settings) {
      std::vector<std::optional<Real>> own;
      for (const std::size_t s : methods) own.push_back(costs[p][s]);
      const auto ratios = cost_ratios(own);
      for (std::size_t i = 0; i < own.size(); ++i)
        means[i] += ratios[i] ? score_of(*ratios[i], end) / Real(settings.size()) : 0;
    }
  }
  return scores;
}

Row mean_scores(const std::vector<Row>& families) {
  Row means(families.empty() ? 0 : families[0].size(), 0);
  for (const Row& row : families)
    for (std::size_t s = 0; s < row.size(); ++s) means[s] += row[s] / Real(families.size());
  return means;
}

// All pairs and all steps in one pass over the flips: a pair that is (i, j > i) in the order of
// leaving belongs to what remains at the steps up to i.
FlipLevels flip_levels(const std::vector<Row>& sums, std::size_t exact_families,
                       std::size_t drawn_flips) {
  const Flips flips(sums);
  const std::size_t k = flips.total.size();
  const auto [order, sizes] = leaving_order(flips);
  // Per pair in the order of leaving: its scale, what its |u| must reach, how often it did.
  Row scale, reach, hits, steps(k, 0);
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = i + 1; j < k; ++j) {
      scale.push_back(flips.scale[order[i]][order[j]]);
      reach.push_back(std::abs(flips.size(order[i], order[j])) - kRounding);
    }
  hits.assign(scale.size(), 0);
  Row sorted(k);
  Vector u(static_cast<Index>(k));
  const auto count_hits = [&](const Row& flipped) {
    for (std::size_t i = 0; i < k; ++i) sorted[i] = flipped[order[i]];
    Real most = 0;
    std::size_t pair = scale.size();
    for (std::size_t i = k - 1; i-- > 0;) {
      const std::size_t count = k - 1 - i;
      pair -= count;
      const Real own = sorted[i];
      for (std::size_t j = 0; j < count; ++j) {
        u[Index(j)] = std::abs(sorted[i + 1 + j] - own) * scale[pair + j];
        hits[pair + j] += u[Index(j)] >= reach[pair + j] ? 1 : 0;
      }
      most = std::max(most, u.head(Index(count)).maxCoeff());  // of whole registers at a time
      steps[i] += most >= sizes[i] - kRounding ? 1 : 0;
    }
  };
  const std::size_t count = flips.each(count_hits, exact_families, drawn_flips);
  FlipLevels levels{.pairs = std::vector<Row>(k, Row(k, 1)), .leaves = Row(k, 1)};
  Real level = 0;
  for (std::size_t i = 0, pair = 0; i < k; ++i) {
    if (i + 1 < k) levels.leaves[order[i]] = level = std::max(level, steps[i] / Real(count));
    for (std::size_t j = i + 1; j < k; ++j, ++pair)
      levels.pairs[order[i]][order[j]] = levels.pairs[order[j]][order[i]] =
          hits[pair] / Real(count);
  }
  levels.first = order.back();
  // Everything else has left, or each alone would.
  levels.is_lead = k > 1;
  bool is_alone = k > 1;
  for (std::size_t s = 0; s < k; ++s) {
    if (s == levels.first) continue;
    levels.is_lead = levels.is_lead && levels.pairs[levels.first][s] <= kSignificant;
    is_alone = is_alone && levels.leaves[s] <= kSignificant;
  }
  levels.is_lead = levels.is_lead || is_alone;
  return levels;
}

bool FlipLevels::is_in_group(std::size_t method) const {
  return is_lead ? method == first : leaves[method] > kSignificant;
}

// 95 % of the mean over families: mean ± t √variance, after adding three quarters of a family that
// scores 0 and as much of one that scores 1. Agresti, Coull (1998) add such to proportions. Without
// them scores that are all alike, as of a method that solved every problem drawn, give an interval
// that covers in 63 % of all samples instead of 95 %.
Interval score_interval(const Row& families) {
  constexpr Real kAdded = 0.75, kConfidenceLevel = 0.975;
  const auto [low, high] = std::ranges::minmax(families);
  if (families.size() < kFewestForInterval) return {low, high};
  const Real n = Real(families.size()), all = n + 2 * kAdded;
  const Real mean = (std::accumulate(families.begin(), families.end(), 0.0) + kAdded) / all;
  Real variance = std::pow(kAdded * mean, 2) + std::pow(kAdded * (1 - mean), 2);
  for (const Real score : families) variance += std::pow(score - mean, 2);
  const Real half = student_quantile(kConfidenceLevel, families.size() - 1) *
                    std::sqrt(variance * (n + 2) / (n + 1)) / all;
  return {std::max(0.0, mean - half), std::min(1.0, mean + half)};
}

WorkRatio work_ratio(const Costs& costs, const std::vector<std::string>& families, std::size_t a,
                     std::size_t b) {
  WorkRatio out;
  Row doublings;
  for (const auto& settings : by_family(families)) {
    Row own;
    for (const std::size_t p : settings) {
      if (!costs[p][a] || !costs[p][b]) continue;
      const Real mine = std::max(*costs[p][a], 1.0), other = std::max(*costs[p][b], 1.0);
      const bool is_mine = mine < kNever, is_other = other < kNever;
      ++(is_mine && is_other ? out.both
         : is_mine           ? out.only_a
         : is_other          ? out.only_b
                             : out.neither);
      if (is_mine && is_other) own.push_back(std::log2(mine) - std::log2(other));
    }
    if (!own.empty()) doublings.push_back(median_of(std::move(own)));
  }
  out.families = doublings.size();
  if (doublings.empty()) return out;
  const MedianInterval interval = median_interval(doublings);
  out.median = std::exp2(interval.median);
  out.low = std::exp2(interval.low);
  out.high = std::exp2(interval.high);
  return out;
}

const Place* Decision::place_of(std::size_t method) const {
  const auto found = std::ranges::find(places, method, &Place::method);
  return found == places.end() ? nullptr : &*found;
}

std::vector<std::size_t> Decision::group() const {
  std::vector<std::size_t> methods;
  for (const Place& place : places)
    if (place.is_in_group) methods.push_back(place.method);
  return methods;
}

std::pair<std::size_t, std::size_t> Decision::group_sizes() const {
  std::pair<std::size_t, std::size_t> sizes{group().size(), group().size()};
  for (const Choice& choice : choices)
    if (choice.group > 0)
      sizes = {std::min(sizes.first, choice.group), std::max(sizes.second, choice.group)};
  return sizes;
}

std::optional<std::size_t> Decision::fewest_wins() const {
  for (std::size_t wins = 1; wins <= families; ++wins)
    if (std::exp2(1 - Real(wins)) <= kSignificant) return wins;
  return std::nullopt;
}

std::vector<Place> ranked_places(const Evidence& evidence) { return Decider(evidence).places(); }
std::optional<Decision> decide(const Evidence& evidence) { return Decider(evidence).decision(); }

}  // namespace isoline::results
