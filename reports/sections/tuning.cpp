// Where the rates of methods came from, and what tuning bought: values tried, edges, the best of b
// of them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
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

  bool is_empty() const { return tuned.empty() && published == 0; }
};

void add_value(const Comparison& c, const Cell& cell, const std::string& option, Rates& rates) {
  const OptionValues& options = c.runs[cell.runs.front()].record->request.optimizer.options;
  const Real value = options.number(option, std::nan(""));
  if (std::isnan(value)) return;
  rates.least = std::min(rates.least, value);
  rates.most = std::max(rates.most, value);
}

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
    add_value(c, cell, rate->option, rates);
  }
  return rates;
}

// The score of a row: 1 the value of least work, 0 one with at least 64 times as much, or unsolved.
std::vector<Real> scores_of(const TunedRate& rate) {
  const Real least = rate.work.empty() ? kNever : *std::ranges::min_element(rate.work);
  std::vector<Real> scores;
  for (const Real work : rate.work)
    scores.push_back(
        work < kNever ? score_of(std::max(work, 1.0) / std::max(least, 1.0), kProfileEnd) : 0);
  return scores;
}

// The mean over settings of the expected score of the best of b values, b = 1, 2, …; grids of fewer
// values keep their last.
std::vector<Real> best_of_curve(const Rates& rates) {
  std::vector<std::vector<Real>> all;
  std::size_t longest = 0;
  for (const TunedRate* rate : rates.tuned) {
    if (rate->work.empty()) continue;
    all.push_back(expected_best(scores_of(*rate)));
    longest = std::max(longest, all.back().size());
  }
  std::vector<Real> mean(longest, 0);
  for (std::size_t b = 0; b < longest; ++b)
    for (const auto& curve : all)
      mean[b] += curve[std::min(b, curve.size() - 1)] / static_cast<Real>(all.size());
  return mean;
}

TableCell score_cell(const std::vector<Real>& curve, std::size_t b) {
  if (curve.size() <= b) return "";
  return {fmt::format("{:.2f}", curve[b]), {{"score", curve[b]}}};
}

Table rates_table(const Comparison& c, const std::vector<Rates>& all) {
  Table table = worded_table("rates", setting_noun(c), n_column(c));
  for (const Rates& rates : all) {
    if (rates.is_empty()) continue;
    const std::vector<Real> curve = best_of_curve(rates);
    constexpr std::size_t kThird = 2;
    std::string values;
    if (rates.most > 0)
      values = rates.least == rates.most
                   ? figure(rates.most)
                   : fmt::format("{}–{}", figure(rates.least), figure(rates.most));
    add_row(
        table, c, rates.optimizer,
        {count_cell(rates.settings), count_cell(rates.tuned.size()), count_cell(rates.published),
         values, count_cell(rates.at_edge), count_cell(rates.never), score_cell(curve, 0),
         score_cell(curve, kThird), score_cell(curve, curve.empty() ? 0 : curve.size() - 1)});
  }
  return table;
}

Plot best_of_plot(const Comparison& c, const std::vector<Rates>& all) {
  Plot plot = worded_plot("plot-best-of", setting_noun(c), kMostLines);
  Real steepest = -1;
  for (const Rates& rates : all) {
    const std::vector<Real> curve = best_of_curve(rates);
    if (curve.size() < 2 || plot.series.size() == kMostLines) continue;
    PlotSeries line{rates.optimizer, optimizer_text(c, rates.optimizer), {}, curve, {}, {}};
    for (std::size_t b = 1; b <= curve.size(); ++b) line.x.push_back(static_cast<Real>(b));
    if (curve.back() - curve.front() > steepest) {
      steepest = curve.back() - curve.front();
      plot.reading =
          words("plot-best-of.reading", line.name, curve.front(), curve.back(), curve.size());
    }
    plot.series.push_back(std::move(line));
  }
  return plot;
}

// Open questions about rates that were tuned.
std::string edges_text(const std::vector<Rates>& all) {
  std::size_t rows = 0, edges = 0, never = 0;
  for (const Rates& rates : all) {
    rows += rates.tuned.size();
    edges += rates.at_edge;
    never += rates.never;
  }
  return rows == 0 ? "" : words("tuning.edges", edges, rows, never);
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
    if (const std::string edges = edges_text(all); !edges.empty())
      section.readings.push_back({"", edges});
    section.tables.push_back(rates_table(c, all));
    if (Plot plot = best_of_plot(c, all); !plot.series.empty())
      section.plots.push_back(std::move(plot));
  } else if (std::ranges::any_of(
                 c.runs, [](const Run& run) { return !run.record->request.rates.empty(); })) {
    section.readings.push_back({"", words("tuning.untold")});
  }
  if (Table both = tuned_and_defaults_table(c); !both.rows.empty())
    section.tables.push_back(std::move(both));
  return section;
}

// The same methods at the rates of tables and at their defaults, on the settings that both were run
// on: what tuning changed where it counts.

namespace {

// How many measured cells the method ran with a spec that is not its bare name: of a table of
// rates, and in any way.
std::array<std::size_t, 2> chosen_cells(const Comparison& c, std::size_t s) {
  std::array<std::size_t, 2> counts{};
  for (const auto& row : c.cells) {
    if (!row[s].is_measured()) continue;
    const Request& request = c.runs[row[s].runs.front()].record->request;
    if (request.optimizer.spec == request.optimizer.name) continue;
    counts[0] += !request.rates.empty();
    ++counts[1];
  }
  return counts;
}

TableCell factor_cell(const std::vector<Real>& doublings) {
  if (doublings.empty()) return "";
  const Real middle = median_of(doublings), edge = std::log2(kProfileEnd);
  return {std::abs(middle) < edge ? fmt::format("{:.2g}", std::exp2(middle))
          : middle < 0            ? "≤ 1/64"
                                  : "≥ 64",
          {{"doublings", middle}}};
}

}  // namespace

Table tuned_and_defaults_table(const Comparison& c) {
  Table table = worded_table("tuned-and-defaults", setting_noun(c), tau_name(c), counted_name(c),
                             n_column(c));
  const Costs costs = median_costs(c, kTightest);
  Families settings;
  for (std::size_t p = 0; p < costs.size(); ++p) settings.push_back({p});
  std::size_t better = 0, worse = 0;
  for (std::size_t a = 0; a < c.optimizers.size(); ++a)
    for (std::size_t b = 0; b < c.optimizers.size(); ++b) {
      const bool is_pair = a != b && c.optimizers[a].method == c.optimizers[b].method;
      if (!is_pair || chosen_cells(c, a)[0] == 0 || chosen_cells(c, b)[1] > 0) continue;
      std::size_t n = 0, solved = 0, solved_plain = 0;
      for (const auto& row : costs) {
        if (!row[a] || !row[b]) continue;
        ++n;
        solved += *row[a] < kNever;
        solved_plain += *row[b] < kNever;
      }
      if (n == 0) continue;
      better += solved > solved_plain;
      worse += solved < solved_plain;
      const Pairing pairing = pairing_of(costs, settings, a, b);
      table.rows.push_back(
          {c.optimizers[b].method, count_cell(n), count_cell(solved), count_cell(solved_plain),
           fmt::format("{} : {}", pairing.wins, pairing.losses), factor_cell(pairing.doublings)});
      table.row_topics.push_back({.method = c.optimizers[b].method});
    }
  table.reading =
      words("tuned-and-defaults.reading", better, table.rows.size(), setting_noun(c), worse);
  return table;
}

}  // namespace isoline::reports
