// Ranks by areas of profiles, pairs by doublings, the lead by sign flips.
#include "reports/read/lead.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/results/statistics.h"
#include "core/results/tests.h"

namespace isoline::reports {
namespace {

Real doublings_of(Real a, Real b) {
  const Real most = std::log2(kProfileEnd);
  if (a == kNever && b == kNever) return 0;
  if (a == kNever || b == kNever) return a == kNever ? most : -most;
  return std::clamp(std::log2(std::max(a, 1.0)) - std::log2(std::max(b, 1.0)), -most, most);
}

// Sums of scores and numbers of problems of each optimizer, over problems of one name.
struct Sums {
  std::vector<Real> score, problems;
  explicit Sums(std::size_t optimizers) : score(optimizers, 0), problems(optimizers, 0) {}
  void add(const Sums& other) {
    for (std::size_t s = 0; s < score.size(); ++s) {
      score[s] += other.score[s];
      problems[s] += other.problems[s];
    }
  }
  Real mean(std::size_t s) const { return score[s] / std::max(problems[s], 1.0); }
  // The part in the first place of s: whole where it is alone, shared where others tie with it.
  Real part_of(std::size_t s) const {
    std::size_t tied = 0;
    for (std::size_t other = 0; other < score.size(); ++other) {
      if (problems[other] == 0) continue;
      if (are_tied(mean(other), mean(s)))
        ++tied;
      else if (mean(other) > mean(s))
        return 0;
    }
    return tied == 0 ? 0 : 1 / Real(tied);
  }
};

std::vector<Sums> sums_by_name(const Costs& costs, const Groups& groups) {
  std::vector<Sums> all;
  for (const auto& rows : groups) {
    Sums sums(costs.empty() ? 0 : costs[0].size());
    for (const std::size_t row : rows) {
      const auto ratios = cost_ratios(costs[row]);
      for (std::size_t s = 0; s < ratios.size(); ++s) {
        if (!ratios[s]) continue;
        sums.score[s] += score_of(*ratios[s], kProfileEnd);
        sums.problems[s] += 1;
      }
    }
    const bool is_asked = std::ranges::any_of(sums.problems, [](Real n) { return n > 0; });
    if (is_asked) all.push_back(std::move(sums));
  }
  return all;
}

Real share_first(const Costs& costs, const Groups& groups, std::size_t leader) {
  const std::vector<Sums> names = sums_by_name(costs, groups);
  Real first = 0;
  resample(names.size(), {0, "report", "resample"}, [&](const Places& places) {
    Sums drawn(costs[0].size());
    for (const std::size_t place : places) drawn.add(names[place]);
    first += drawn.part_of(leader);
  });
  return first / Real(kDraws);
}

void adjust(std::vector<Rival>& rivals) {
  std::vector<Real> p;
  for (const Rival& rival : rivals) p.push_back(rival.p);
  const std::vector<Real> adjusted = holm(p);
  for (std::size_t i = 0; i < rivals.size(); ++i) rivals[i].adjusted = adjusted[i];
}

Real mean_of(const std::vector<Real>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / std::max(Real(values.size()), 1.0);
}

bool is_behind(const Rival& rival) { return mean_of(rival.pairing.doublings) < 0; }

}  // namespace

Real Pairing::typical() const { return doublings.empty() ? 1 : std::exp2(-median_of(doublings)); }

std::array<Real, 2> Pairing::interval() const {
  const MedianInterval interval = median_interval(doublings);
  return {std::exp2(-interval.high), std::exp2(-interval.low)};
}

Pairing pairing_of(const Costs& costs, const Groups& groups, std::size_t a, std::size_t b) {
  Pairing pairing;
  for (const auto& rows : groups) {
    std::vector<Real> values;
    bool is_solved = false;
    for (const std::size_t row : rows) {
      const auto &mine = costs[row][a], &other = costs[row][b];
      if (!mine || !other) continue;
      is_solved = is_solved || *mine < kNever || *other < kNever;
      values.push_back(doublings_of(*mine, *other));
    }
    if (values.empty()) continue;
    pairing.neither += !is_solved;
    if (!is_solved) continue;
    const Real middle = median_of(std::move(values));
    pairing.doublings.push_back(middle);
    ++(middle < 0 ? pairing.wins : middle > 0 ? pairing.losses : pairing.ties);
  }
  return pairing;
}

bool are_tied(Real score, Real other) {
  constexpr Real kRounding = 1e-12;  // sums of the same scores in another order
  return std::abs(score - other) <= kRounding;
}

std::vector<Scored> ranked_by(const Costs& costs) {
  std::vector<Scored> all(costs.empty() ? 0 : costs[0].size());
  for (std::size_t s = 0; s < all.size(); ++s) all[s].optimizer = s;
  for (const auto& row : costs) {
    const auto ratios = cost_ratios(row);
    Real least = kNever;
    for (const auto& cost : row) least = std::min(least, cost.value_or(kNever));
    for (std::size_t s = 0; s < ratios.size(); ++s) {
      if (!ratios[s]) continue;
      ++all[s].problems;
      all[s].score += score_of(*ratios[s], kProfileEnd);
      all[s].solved += *ratios[s] < kNever;
      all[s].wins += *row[s] < kNever && *row[s] == least;
    }
  }
  std::erase_if(all, [](const Scored& scored) { return scored.problems == 0; });
  for (Scored& scored : all) scored.score /= static_cast<Real>(scored.problems);
  std::ranges::stable_sort(all, std::ranges::greater{}, &Scored::score);
  return all;
}

bool Rival::is_told() const { return adjusted <= kSignificant && is_behind(*this); }

std::size_t Lead::told() const {
  return static_cast<std::size_t>(std::ranges::count_if(rivals, &Rival::is_told));
}

std::optional<Lead> lead_among(const Costs& costs, const Groups& groups,
                               const std::vector<bool>& in_family) {
  Lead lead{.ranked = ranked_by(costs), .rivals = {}};
  if (lead.ranked.empty() || lead.ranked[0].score == 0) return std::nullopt;
  const Scored& first = lead.ranked[0];
  lead.tied = static_cast<std::size_t>(std::ranges::count_if(
      lead.ranked, [&](const Scored& each) { return are_tied(each.score, first.score); }));
  bool is_settled = lead.tied == 1;
  for (std::size_t i = 1; i < lead.ranked.size(); ++i) {
    const std::size_t other = lead.ranked[i].optimizer;
    if (!in_family[other]) continue;
    Rival rival{.optimizer = other, .pairing = pairing_of(costs, groups, first.optimizer, other)};
    rival.p = sign_flip_p(rival.pairing.doublings);
    is_settled = is_settled && rival.pairing.doublings.size() >= kLeastNames &&
                 rival.p <= kSignificant && is_behind(rival);
    lead.rivals.push_back(std::move(rival));
  }
  adjust(lead.rivals);
  lead.is_settled = is_settled && !lead.rivals.empty();
  lead.stays_first = share_first(costs, groups, first.optimizer);
  return lead;
}

Real detectable_factor(const Pairing& pairing) {
  return std::exp2(detectable_mean(deviation_of(pairing.doublings), pairing.doublings.size()));
}

}  // namespace isoline::reports
