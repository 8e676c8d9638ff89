// The invariants of a record, each with the message about its violation.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <vector>

#include "core/errors.h"
#include "core/files.h"
#include "core/oracle.h"
#include "core/records/record.h"
#include "core/spec.h"
#include "core/status.h"
#include "core/text.h"

namespace isoline {
namespace {

using Works = std::vector<std::int64_t>;

// Sums and products in another order; a target is compared with the same formula that set it.
constexpr Real kRounding = 1e-12;
constexpr Real kSquares = 1e-6;  // sums of squares in another order, in single precision, too
// For a loss below its declared minimum by single precision, as a share of its scale.
constexpr Real kBelowMinimum = 1e-6;

bool are_same(Real a, Real b) { return a == b || (std::isnan(a) && std::isnan(b)); }

constexpr std::size_t kMostQuoted = 60;  // bytes

// Whether it reads as a specification of that name; an older record has none as typed.
bool is_of(const std::string& spec, const std::string& name) {
  try {
    return spec.empty() || parse_spec(spec).name == name;
  } catch (const UsageError&) {
    return false;
  }
}

std::string number_text(const std::optional<Real>& value) {
  return value ? fmt::format("{}", *value) : "unknown";
}

class Invariants {
 public:
  explicit Invariants(const Record& record)
      : record_(record), curve_(record.curve), summary_(record.summary) {
    const bool is_own = !record.imported && record.status != Status::inapplicable;
    const bool broke_off = is_failure(record.status) || record.status == Status::interrupted;
    const std::string cell = cell_digest(record.request);
    hold(cell == record.cell, "its cell is {}, but the digest of its request is {}", record.cell,
         cell);
    hold(record.criterion.empty() || record.criterion == digest_of(criterion_of(record)),
         "its criterion is not the digest of its f_L, scale, x_scale, x_floor, aim and nominal "
         "costs");
    for (const Component* component : {&record.request.problem, &record.request.optimizer})
      for (const std::string* spec : {&component->spec, &component->asked})
        hold(is_of(*spec, component->name), "'{}' is no specification of {}",
             cut(*spec, kMostQuoted), cut(component->name, kMostQuoted));
    check_signs();
    if (!is_own) return;
    hold(std::ranges::adjacent_find(curve_.iteration, std::greater_equal()) ==
             curve_.iteration.end(),
         "the iterations of its curve do not increase");
    hold(std::ranges::is_sorted(curve_.work), "the work of its curve decreases");
    for (const std::vector<Real>* times : {&curve_.wall_seconds, &curve_.processor_seconds})
      hold(std::ranges::is_sorted(*times), "the times of its curve decrease");
    if (!broke_off) check_ends();
    check_prices();
    check_rounds(curve_.rounds, curve_.work);
    for (const std::optional<Hits>* hits : {&record.hits, &record.x_hits})
      if (*hits) check_rounds((*hits)->rounds, (*hits)->work);
    check_losses();
    if (record.hits && record.minimum && record.scale) check_hits(*record.hits);
    if (record.x_hits && record.x_scale)
      check_columns_of(*record.x_hits, curve_.x_error, kRounding * *record.x_scale,
                       [&](Real tau) { return x_goal(tau, *record.x_scale, record.x_floor); });
    if (!broke_off) check_verdicts();
    if (!broke_off) check_answer();
  }

  std::vector<std::string> broken() && { return std::move(broken_); }

 private:
  template <class... Parts>
  void hold(bool holds, fmt::format_string<const Parts&...> law, const Parts&... parts) {
    if (!holds) broken_.push_back(fmt::format(law, parts...));
  }

  void check_signs() {
    const auto is_negative = [](Real value) { return value < 0; };  // not-a-number is allowed
    for (const auto& [name, works] :
         {std::pair("iterations", &curve_.iteration), {"work", &curve_.work}})
      hold(std::ranges::none_of(*works, is_negative), "its {} are negative", name);
    for (const std::vector<Real>* times :
         {&curve_.wall_seconds, &curve_.processor_seconds, &record_.repeat_wall_seconds})
      hold(std::ranges::none_of(*times, is_negative), "its times are negative");
    hold(summary_.work >= 0 && summary_.iterations >= 0 && summary_.rejected_steps >= 0 &&
             summary_.peak_memory_bytes >= 0 && !is_negative(summary_.wall_seconds) &&
             !is_negative(summary_.processor_seconds),
         "its summary has negative counts, times or memory");
    hold(std::ranges::none_of(record_.counts, is_negative), "its counts are negative");
  }

  // The summary is the first and the last point of the curve. Of one point both are it.
  void check_ends() {
    if (curve_.iteration.empty()) return;
    const struct {
      const char* name;
      Real summary, curve;
    } ends[] = {
        {"iterations", Real(summary_.iterations), Real(curve_.iteration.back())},
        {"work", Real(summary_.work), Real(curve_.work.back())},
        {"loss", summary_.loss, curve_.loss.back()},
        {"error in x", summary_.x_error, curve_.x_error.back()},
        {"gradient norm", summary_.gradient_norm, curve_.gradient_norm.back()},
        {"loss at the start", summary_.start_loss, curve_.loss.front()},
        {"error in x at the start", summary_.start_x_error, curve_.x_error.front()},
    };
    const std::size_t count = curve_.iteration.size() > 1 ? std::size(ends) : std::size(ends) - 2;
    for (std::size_t i = 0; i < count; ++i)
      hold(are_same(ends[i].summary, ends[i].curve),
           "its {} is {} in the summary and {} in the curve", ends[i].name, ends[i].summary,
           ends[i].curve);
    for (std::size_t kind = 0; kind < kOracles; ++kind) {
      const auto column = curve_.counts.find(std::string(kOracleNames[kind]));
      if (column != curve_.counts.end())
        hold(column->second.back() == record_.counts[kind],
             "its calls of {} are {}, and {} at the end of the curve", column->first,
             record_.counts[kind], column->second.back());
    }
  }

  void check_prices() {
    if (std::ranges::none_of(record_.prices, std::identity())) return;
    std::int64_t total = 0;
    for (std::size_t kind = 0; kind < kOracles; ++kind)
      total += record_.counts[kind] * record_.prices[kind];
    hold(total == summary_.work, "its work is {}, but its calls cost {}", summary_.work, total);
    const auto check = [&](const char* whose, const std::map<std::string, Works>& counts,
                           const Works& works) {
      if (counts.empty()) return;
      Works priced(works.size());
      for (std::size_t kind = 0; kind < kOracles; ++kind)
        if (const auto column = counts.find(std::string(kOracleNames[kind]));
            column != counts.end())
          for (std::size_t i = 0; i < works.size(); ++i)
            priced[i] += column->second[i] * record_.prices[kind];
      for (std::size_t i = 0; i < works.size(); ++i)
        if (works[i] >= 0 && priced[i] != works[i])
          return hold(false, "the work of its {} is not the nominal cost of its calls", whose);
    };
    check("curve", curve_.counts, curve_.work);
    for (const std::optional<Hits>* hits : {&record_.hits, &record_.x_hits})
      if (*hits) check("hits", (*hits)->counts, (*hits)->work);
  }

  // W workers need at most as many rounds as a single one, and at least a W-th of them.
  void check_rounds(const std::map<std::string, Works>& rounds, const Works& works) {
    for (const auto& [workers, column] : rounds)
      for (std::size_t i = 0; i < works.size(); ++i)
        if (works[i] >= 0 &&
            (column[i] > works[i] || Real(column[i]) * std::atof(workers.c_str()) < Real(works[i])))
          return hold(false, "its {} rounds of {} workers do not fit its work, {}", column[i],
                      workers, works[i]);
  }

  Real size() const {
    return std::max(std::abs(record_.minimum.value_or(0)), std::abs(record_.scale.value_or(0)));
  }

  void check_losses() {
    for (const Real loss : curve_.loss)
      if (std::isfinite(loss) && !(summary_.best_loss <= loss))
        return hold(false, "its best loss is {}, but a loss of its curve is {}", summary_.best_loss,
                    loss);
    // Older records do not say whether f_L is declared, or the best loss known.
    const bool is_declared = !record_.criterion.empty() && !record_.is_best_known;
    if (is_declared && record_.minimum)
      hold(!(summary_.best_loss < *record_.minimum - kBelowMinimum * size()),
           "its best loss, {}, is below the minimum that its problem declares, {}",
           summary_.best_loss, *record_.minimum);
  }

  Real goal_at(Real tau) const { return *record_.minimum + tau * *record_.scale; }
  Real slack() const { return kRounding * size(); }

  void check_hits(const Hits& hits) {
    check_columns_of(hits, curve_.loss, slack(), [&](Real tau) { return goal_at(tau); });
    for (std::size_t j = 0; j < hits.target.size(); ++j) {
      const Real goal = goal_at(hits.target[j]);
      if (hits.iteration[j] < 0)
        hold(!(summary_.best_loss < goal - slack()),
             "it did not reach the target {}, but its best loss is {}", hits.target[j],
             summary_.best_loss);
      else
        hold(summary_.best_loss <= goal + slack(),
             "it reached the target {}, {}, but its best loss is {}", hits.target[j], goal,
             summary_.best_loss);
    }
  }

  // A target is met by the iterate of an iteration, or by a trial on the way to the next one; by a
  // kept point at the latest.
  template <class Goal>
  void check_columns_of(const Hits& hits, const std::vector<Real>& values, Real slack,
                        const Goal& goal_at) {
    const auto forwards = hits.counts.find(std::string(kOracleNames[0]));
    hold(forwards == hits.counts.end() || forwards->second == hits.forwards,
         "the forward solves of its hits are not those of its counts");
    for (std::size_t j = 0; j < hits.target.size(); ++j) {
      hold(std::abs(hits.target[j] - rung(j)) <= kRounding * rung(j),
           "its target {} is not the one of this place, {}", hits.target[j], rung(j));
      hold(!(hits.wall_seconds[j] < 0), "its hits have negative times");
      const Real goal = goal_at(hits.target[j]);
      for (std::size_t i = 0; i < curve_.iteration.size(); ++i)
        if (is_beside(hits, j, i, values[i] < goal - slack))
          return hold(false,
                      "its target {} is not reached where its curve reaches it, at "
                      "iteration {}",
                      hits.target[j], curve_.iteration[i]);
    }
  }

  // A kept point before it has not met it and took no more; one after it took no less. None has met
  // a target that was not reached.
  bool is_beside(const Hits& hits, std::size_t j, std::size_t i, bool has_met) const {
    const std::int64_t hit = hits.iteration[j], at = curve_.iteration[i];
    if (hit < 0) return has_met;
    if (at < hit) return curve_.work[i] > hits.work[j] || has_met;
    return at > hit && curve_.work[i] < hits.work[j];
  }

  // At the returned point, which is the last.
  void check_verdicts() {
    const bool has_returned = !curve_.loss.empty();
    const auto check = [&](const char* name, const auto& verdicts, const auto& is_met) {
      for (const auto& [text, tau] : kVerified)
        if (const auto at = verdicts.find(text); at != verdicts.end() && at->second)
          hold(*at->second == (has_returned && is_met(tau)),
               "it is {}{} to {}, but its last point contradicts this", *at->second ? "" : "not ",
               name, text);
    };
    if (record_.minimum && record_.scale)
      check("verified", record_.verified, [&](Real tau) {
        return std::isfinite(summary_.loss) && summary_.loss <= goal_at(tau);
      });
    if (record_.x_scale)
      check("found", record_.found, [&](Real tau) {
        return summary_.x_error <= x_goal(tau, *record_.x_scale, record_.x_floor);
      });
    if (record_.status == Status::discrepancy) check_discrepancy();
    if (record_.status != Status::target || !record_.scale) return;
    const Real tau = record_.request.budget.target;
    // Older runs whose criterion is the error in x were stopped at τ² of the loss.
    const bool is_in_x = record_.aim == Aim::x && record_.x_scale &&
                         summary_.x_error <= x_goal(tau, *record_.x_scale, record_.x_floor);
    const Real of_loss = record_.aim == Aim::x ? tau * tau : tau;
    hold(is_in_x || (record_.minimum && summary_.best_loss <= goal_at(of_loss) + slack()),
         "its status is target, but its best loss, {}, is above the target", summary_.best_loss);
  }

  // The answer is where the run returned: the last of its path, and what its uncertainty is of. Its
  // residual norm gives a mean of squares over samples as the loss, with ½ or without, and the
  // variance where the noise is not given.
  void check_answer() {
    if (!record_.answer || record_.request.problem.is_learned) return;
    const std::span<const Real> x = record_.answer->point(kReturned);
    const auto is_returned = [&](const std::vector<Real>& other) {
      return x.empty() || other.size() != x.size() ||
             std::equal(x.begin(), x.end(), other.begin(), are_same);
    };
    if (record_.trajectory && !record_.trajectory->x.empty())
      hold(is_returned(record_.trajectory->x.back()),
           "its answer is not the last point of its trajectory");
    if (record_.uncertainty)
      hold(is_returned(record_.uncertainty->x), "its uncertainty is of another x than its answer");
    if (!record_.answer->residual_norm) return;
    const Real squared = std::pow(*record_.answer->residual_norm, 2), loss = summary_.loss;
    const OptionValues& options = record_.request.problem.options;
    const bool is_told = options.find("loss") == nullptr && options.number("tikhonov", 0) == 0;
    const auto is_below = [&](Real least) {
      return squared < least * (1 - kSquares) - kRounding * slack();
    };
    if (is_told && std::isfinite(squared) && std::isfinite(loss))
      hold(!is_below(loss), "the norm of its residual is {}, which its loss, {}, contradicts",
           *record_.answer->residual_norm, loss);
    if (!is_told || !record_.uncertainty || record_.noise_level || is_below(2 * loss)) return;
    const Real sum = record_.uncertainty->variance * Real(record_.uncertainty->degrees_of_freedom);
    hold(std::abs(squared - sum) <= kSquares * (squared + sum) + kRounding * slack(),
         "its variance times its degrees of freedom is not the square of its residual");
  }

  // The first point within the noise is the last.
  void check_discrepancy() {
    const std::vector<Real>& all = curve_.discrepancy;
    const Real most =
        record_.request.budget.discrepancy * record_.noise_level.value_or(std::nan(""));
    hold(!all.empty() && all.back() <= most &&
             std::none_of(all.begin(), all.end() - 1, [&](Real each) { return each <= most; }),
         "its status is discrepancy, but its last point is not the first within τδ, {}", most);
  }

  const Record& record_;
  const Curve& curve_;
  const Summary& summary_;
  std::vector<std::string> broken_;
};

}  // namespace

// The nominal cost of a sparse Jacobian belongs to it where a run counts one: so the criterion of
// all other runs is that of records from before.
Criterion criterion_of(const Record& record) {
  constexpr auto kSparse = static_cast<std::size_t>(Oracle::sparse_jacobian);
  OracleCounts prices = record.prices;
  if (record.counts[kSparse] == 0) prices[kSparse] = 0;
  return {record.minimum, record.scale, record.x_scale, record.x_floor, record.aim, prices};
}

std::string digest_of(const Criterion& criterion) {
  std::vector<std::int64_t> prices(criterion.prices.begin(), criterion.prices.end());
  const auto sparse = prices.begin() + static_cast<std::ptrdiff_t>(Oracle::sparse_jacobian);
  if (*sparse == 0) prices.erase(sparse);
  return digest(fmt::format("{} {} {} {} {} {}", number_text(criterion.minimum),
                            number_text(criterion.scale), number_text(criterion.x_scale),
                            criterion.x_floor, name_of(criterion.aim), fmt::join(prices, " ")));
}

std::vector<std::string> broken_invariants(const Record& record) {
  return Invariants(record).broken();
}

}  // namespace isoline
