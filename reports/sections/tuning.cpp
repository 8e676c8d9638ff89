// Where the rates of methods came from, and what tuning bought: values tried, edges, the best of b
// of them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// The rates of one method over its settings.
struct Rates {
  std::size_t optimizer = 0;
  std::size_t settings = 0, published = 0, at_edge = 0, never = 0;
  std::vector<const TunedRate*> tuned;
  Real least = kNever, most = 0;  // values chosen
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
std::vector<Real> best_of_curve(const Rates& rates) {
  std::vector<std::vector<Real>> all;
  std::size_t longest = 0;
  for (const TunedRate* rate : rates.tuned) {
    if (rate->work.empty()) continue;
    const Real least = std::max(std::ranges::min(rate->work), 1.0);
    std::vector<Real> scores;
    for (const Real work : rate->work)
      scores.push_back(work < kNever ? score_of(std::max(work, 1.0) / least, kProfileEnd) : 0);
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
    const std::vector<Real> curve = best_of_curve(rates);
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

}  // namespace

std::string rates_text(const Comparison& c) {
  std::set<std::string> methods, tuned, published, tunable;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const std::string& method = c.optimizers[s].method;
    methods.insert(method);
    const Sheet* sheet = c.optimizers[s].sheet;
    if (sheet != nullptr && !sheet->tunable.empty()) tunable.insert(method);
    for (std::size_t p = 0; p < c.problems.size(); ++p) {
      const Origin origin = origin_of(c, p, s);
      if (origin == Origin::tuned) tuned.insert(method);
      if (origin == Origin::published) published.insert(method);
    }
  }
  if (tuned.empty() && published.empty()) return "";
  for (const std::string& method : tuned) published.erase(method);
  // Older sheets do not say which options can be tuned.
  const std::size_t fixed = tunable.empty() ? 0 : methods.size() - tunable.size();
  return words("tuning.methods", methods.size(), tuned.size(), setting_noun(c),
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
  } else if (std::ranges::any_of(
                 c.runs, [](const Run& run) { return !run.record->request.rates.empty(); })) {
    section.readings.push_back({"", words("tuning.untold")});
  }
  return section;
}

}  // namespace isoline::reports
