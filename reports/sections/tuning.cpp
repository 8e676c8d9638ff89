// The origin of the methods' rates and the effect of tuning: values tried, edges of grids, the best
// of b values.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// The trials on the setting of a value that was chosen on other families; null where none are
// known.
const TunedRate* trials_of(const Comparison& c, const TunedRate& rate) {
  if (!rate.is_left_out()) return &rate;
  for (const TunedRate& trials : c.study->rates)
    if (trials.problem == rate.problem && trials.optimizer == rate.optimizer && trials.is_tuned() &&
        !trials.is_left_out())
      return &trials;
  return nullptr;
}

// The rates of one method over its settings.
struct Rates {
  std::size_t optimizer = 0;
  std::size_t settings = 0, published = 0, at_edge = 0, never = 0;
  std::vector<const TunedRate*> tuned;
  Real least = kNever, most = 0;  // chosen values
};

Rates rates_of(const Comparison& c, std::size_t s) {
  Rates rates{.optimizer = s, .tuned = {}};
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const Cell& cell = c.cell(p, s);
    rates.settings += cell.planned > 0;
    const TunedRate* rate = rate_of(c, p, s);
    if (rate == nullptr) continue;
    if (!rate->is_tuned()) {
      ++rates.published;
      continue;
    }
    rates.tuned.push_back(rate);
    rates.at_edge += rate->is_at_edge;
    rates.never += !rate->is_ever_solved();
    const OptionValues& options = c.runs[cell.runs.front()].record->request.optimizer.options;
    const Real value = options.number(rate->option, std::nan(""));
    if (std::isnan(value)) continue;
    rates.least = std::min(rates.least, value);
    rates.most = std::max(rates.most, value);
  }
  return rates;
}

// The mean over settings of the expected score of the best of b values, b = 1, 2, …; grids of fewer
// values keep their last. The score is 1 of the value of least work, 0 of one with at least 64
// times as much, or unsolved.
std::vector<Real> best_of_curve(const Comparison& c, const Rates& rates) {
  std::vector<std::vector<Real>> all;
  std::size_t longest = 0;
  for (const TunedRate* chosen : rates.tuned) {
    const TunedRate* rate = trials_of(c, *chosen);
    if (rate == nullptr || rate->work.empty()) continue;
    std::vector<Real> scores;
    for (const auto& ratio : cost_ratios({rate->work.begin(), rate->work.end()}))
      scores.push_back(score_of(*ratio, kProfileEnd));
    all.push_back(expected_best(scores));
    longest = std::max(longest, all.back().size());
  }
  std::vector<Real> mean(longest, 0);
  for (std::size_t b = 0; b < longest; ++b)
    for (const auto& curve : all)
      mean[b] += curve[std::min(b, curve.size() - 1)] / static_cast<Real>(all.size());
  return mean;
}

Table rates_table(const Comparison& c, const std::vector<Rates>& all) {
  Table table = worded_table("rates", setting_noun(c), n_column(c));
  for (const Rates& rates : all) {
    if (rates.tuned.empty() && rates.published == 0) continue;
    const std::vector<Real> curve = best_of_curve(c, rates);
    const auto score = [&](std::size_t b) -> TableCell {
      if (curve.size() <= b) return "";
      return {fmt::format("{:.2f}", curve[b]), {{"score", curve[b]}}};
    };
    std::string values;
    if (rates.most > 0)
      values = rates.least == rates.most
                   ? figure(rates.most)
                   : fmt::format("{}–{}", figure(rates.least), figure(rates.most));
    add_row(
        table, c, rates.optimizer,
        {count_cell(rates.settings), count_cell(rates.tuned.size()), count_cell(rates.published),
         values, count_cell(rates.at_edge), count_cell(rates.never), score(0), score(2),
         score(curve.empty() ? 0 : curve.size() - 1)});
  }
  return table;
}

// For each setting, the work of tuning's runs with a method's value of its option: chosen on other
// families, the best on the setting itself, and the default.
constexpr std::size_t kChoices = 3;

Table three_choices_table(const Comparison& c) {
  std::array<Costs, kChoices> costs;
  costs.fill(Costs(c.problems.size(), std::vector<std::optional<Real>>(c.optimizers.size())));
  std::vector<Real> spent(c.optimizers.size(), 0);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    for (std::size_t p = 0; p < c.problems.size(); ++p) {
      const TunedRate* chosen = rate_of(c, p, s);
      const TunedRate* trials =
          chosen && chosen->is_left_out() && chosen->value ? trials_of(c, *chosen) : nullptr;
      if (trials == nullptr || trials->work.empty() || !trials->standard) continue;
      costs[0][p][s] = trials->work_of(*chosen->value);
      costs[1][p][s] = std::ranges::min(trials->work);
      costs[2][p][s] = trials->work_of(*trials->standard);
      spent[s] = chosen->spent;
    }
  Table table = worded_table("tuning-choices", setting_noun(c), n_column(c));
  std::array<Costs, kChoices> ratios;
  for (std::size_t i = 0; i < kChoices; ++i) ratios[i] = ratios_of(costs[i]);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    std::size_t settings = 0;
    std::array<Real, kChoices> sums{};
    for (std::size_t p = 0; p < c.problems.size(); ++p) {
      if (!costs[0][p][s]) continue;
      ++settings;
      for (std::size_t i = 0; i < kChoices; ++i)
        if (const Real ratio = ratios[i][p][s].value_or(kNever); ratio < kNever)
          sums[i] += score_of(ratio, kProfileEnd);
    }
    if (settings == 0) continue;
    std::vector<TableCell> cells{count_cell(settings)};
    for (const Real sum : sums) {
      const Real score = sum / static_cast<Real>(settings);
      cells.push_back({fmt::format("{:.2f}", score), {{"score", score}}});
    }
    cells.push_back(number_cell("work", spent[s]));
    add_row(table, c, s, std::move(cells));
  }
  return table;
}

}  // namespace

std::string rates_text(const Comparison& c) {
  std::set<std::string> methods, tuned, published, tunable;
  std::size_t elsewhere = 0, rows = 0;
  bool is_left_out = false;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const std::string& method = c.optimizers[s].method;
    methods.insert(method);
    const Sheet* sheet = c.optimizers[s].sheet;
    if (sheet != nullptr && !sheet->tunable.empty()) tunable.insert(method);
    for (std::size_t p = 0; p < c.problems.size(); ++p) {
      const Origin origin = origin_of(c, p, s);
      if (origin == Origin::tuned) {
        tuned.insert(method);
        is_left_out |= rate_of(c, p, s)->is_left_out();
        elsewhere += !rate_of(c, p, s)->setting.empty();
        ++rows;
      }
      if (origin == Origin::published) published.insert(method);
    }
  }
  if (tuned.empty() && published.empty()) return "";
  for (const std::string& method : tuned) published.erase(method);
  // Older component metadata do not state which options can be tuned.
  const std::size_t fixed = tunable.empty() ? 0 : methods.size() - tunable.size();
  return words("tuning.methods", methods.size(), tuned.size(),
               is_left_out      ? words("tuning.others")
               : elsewhere == 0 ? words("tuning.same", setting_noun(c))
                                : words("tuning.elsewhere", elsewhere, rows),
               published.empty() ? "" : fmt::format(", and {} published ones", published.size()),
               fixed == 0 ? "" : fmt::format(", {} with nothing to tune", fixed));
}

Section tuning_section(const Comparison& c) {
  Section section = worded_section("tuning");
  std::vector<Rates> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) all.push_back(rates_of(c, s));
  if (const std::string text = rates_text(c); !text.empty()) {
    section.readings.push_back({"", text});
    std::size_t rows = 0, edges = 0, never = 0;
    for (const Rates& rates : all) {
      rows += rates.tuned.size();
      edges += rates.at_edge;
      never += rates.never;
    }
    if (rows > 0) section.readings.push_back({"", words("tuning.edges", edges, rows, never)});
    section.tables.push_back(rates_table(c, all));
    if (Table choices = three_choices_table(c); !choices.rows.empty())
      section.tables.push_back(std::move(choices));
  } else if (std::ranges::any_of(
                 c.runs, [](const Run& run) { return !run.record->request.rates.empty(); })) {
    section.readings.push_back({"", words("tuning.untold")});
  }
  return section;
}

}  // namespace isoline::reports
