// Which method is best over a set of settings, and what the data allow to be said of it: one
// decision, from which every sentence, mark and band of a report is derived.
//
//   score of a method on a setting:  a = max(0, log2 e − log2 r) / log2 e, r its cost over the
//                                    least of those compared, e the profile's end; 0 where unsolved
//   in a family:                     a_g = mean of a over its settings, the area of its profile
//   score of a method:               A = mean of a_g over families
//   difference of two methods:       D = Σ over families of d_g, that of their a_g
//   its size:                        u = D / √(Σ d_g²), which Student's t grows with
//
// Settings of one family (sizes and variants of a problem) are no independent witnesses: their
// differences change sign together. Under the null the signs of all d_g are arbitrary, the same for
// all pairs of methods: 2^(G−1) flips, all of them up to kExactFlips families.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/real.h"
#include "core/results/statistics.h"

namespace isoline::results {

inline constexpr Real kProfileEnd = 64;  // the factor up to which a profile's area ranks
inline constexpr Real kSignificant = 0.05;
// Up to so many families all flips are counted; of more, so many fixed ones.
inline constexpr std::size_t kExactFlips = 20, kDrawnFlips = 1U << 16U;

// The results of all methods on one setting from one seed, which names an instance and a start.
struct Repetition {
  std::uint64_t seed = 0;
  std::vector<std::optional<Real>> costs;  // [method]; nothing where no such run exists
};

enum class Varied { profile_end, tolerance, measure, prices, family, linear, seed };

// Other costs of the same methods on the same settings: to another tolerance, in time, or at other
// prices.
struct OtherCosts {
  Varied varied = Varied::tolerance;
  std::string value;  // which tolerance, which measure, or which oracle at which factor
  Costs costs;
};

// The scores of these methods among each other in each family: [family][place in `methods`], in the
// order in which families come first. `families` names that of each setting.
std::vector<std::vector<Real>> family_scores(const Costs& costs,
                                             const std::vector<std::string>& families,
                                             const std::vector<std::size_t>& methods,
                                             Real end = kProfileEnd);
std::vector<Real> mean_scores(const std::vector<std::vector<Real>>& families);

struct Evidence {
  Costs costs;  // [setting][method]: medians; infinite where unsolved, nothing where never run
  std::vector<std::string> families;                 // [setting]
  std::vector<bool> linear = {};                     // [setting], or none at all
  std::vector<std::vector<Repetition>> repetitions;  // [setting], or none at all
  std::vector<OtherCosts> others;
};

// Work of `a` over that of `b` where both solve, the middle of families (of a family the middle of
// its settings); ratios are true ones, not limited by the profile's end.
struct WorkRatio {
  Real median = 1, low = 0, high = kNever;  // 95 % by the test of signs; the range of fewer than 6
  std::size_t families = 0;                 // with a setting that both solve
  std::size_t both = 0, only_a = 0, only_b = 0, neither = 0;  // settings
  bool is_range() const { return families < kFewestForInterval; }
};
WorkRatio work_ratio(const Costs& costs, const std::vector<std::string>& families, std::size_t a,
                     std::size_t b);

// The result of the flips for methods whose scores are sums[family][method], times any number.
struct FlipLevels {
  std::vector<std::vector<Real>> pairs;  // [method][method] p of the pair alone, two-sided
  std::vector<Real> leaves;  // [method] the level at which it leaves the confidence set of the best
  std::size_t first = 0;     // the greatest sum
  bool is_lead = false;      // which is significantly greater than each other

  bool is_in_group(std::size_t method) const;
};

// The confidence set of the best, by a step-down test over all pairs (Romano, Wolf 2005; Hansen,
// Lunde, Nason 2011): the method against which some other has the greatest u leaves if that u
// exceeds the 0.95 quantile of the greatest u of all remaining pairs under the flips, and so on. If
// several methods tie for the best, the chance that any of them leaves is at most 5 %, which the
// tests hold by simulation; a quantile for each method alone would drop one of 40 in four of five
// data sets. A first method whose p against each other one is at most 0.05 leads
// (intersection-union), and is then the whole group.
FlipLevels flip_levels(const std::vector<std::vector<Real>>& sums,
                       std::size_t exact_families = kExactFlips,
                       std::size_t drawn_flips = kDrawnFlips);

// 95 % of a mean score over families, by the score in each; of fewer than 6 families their range.
Interval score_interval(const std::vector<Real>& families);

// A ranked method: one that was run on every setting.
struct Place {
  std::size_t method = 0;
  Real score = 0;
  Interval interval;  // of the score, 95 % over families; the range where is_range of the decision
  std::size_t solved = 0, wins = 0;  // settings; wins: least cost of all ranked, ties for each
  Real share_first =
      0;              // of the bootstrap's samples in which it has the greatest score; ties share
  Real p = 1;         // of its difference from the first alone, two-sided
  Real adjusted = 1;  // at which level it leaves the confidence set of the best
  bool is_in_group = false;  // not significantly worse than the best
  WorkRatio ratio;           // its work over that of the first
};

// An alternative choice, and the leader under it.
struct Choice {
  Varied varied = Varied::profile_end;
  std::string value;
  std::vector<std::size_t> first;  // methods; several where they tie, none where nothing is solved
  bool is_kept = false;            // the decision's first place is among them
  std::size_t group = 0;           // methods not significantly worse than the best
};

struct Decision {
  std::vector<Place> places;          // best first
  std::vector<std::size_t> unranked;  // run on some settings only
  std::size_t settings = 0, families = 0;
  std::size_t tied = 1;      // so many places share the greatest score
  bool is_lead = false;      // the first place is significantly better than each other
  bool is_range = false;     // too few families for intervals
  Real least_p = 1;          // 2^(1−families), which no result can go below
  Real friedman = 1;         // p, over ranks by family
  Real detectable = kNever;  // the difference of scores, as variable as that of the first two, that
                             // is found in 80 % of all samples
  std::vector<Choice> choices;

  const Place* place_of(std::size_t method) const;  // none if not ranked
  std::vector<std::size_t> group() const;           // methods not significantly worse than the best
  // The least and the greatest size of that group over the decision and all choices that find one.
  std::pair<std::size_t, std::size_t> group_sizes() const;
  // A pair's p is at most 5 % only where one is better on so many families at least: if k families
  // go against it, 2^(k+1) of the 2^n flips are as far out. Nothing where n families never can.
  std::optional<std::size_t> fewest_wins() const;
};

// Best first, without `share_first`; none where no ranked method solves a setting.
std::vector<Place> ranked_places(const Evidence& evidence);
// Nothing where there are none.
std::optional<Decision> decide(const Evidence& evidence);

}  // namespace isoline::results
