// Where the rates of methods came from, and what tuning bought: values tried, edges, the best of b
// of them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/results/statistics.h"
#include "reports/sections/claim_terms.h"
#include "reports/sections/evidence.h"
#include "reports/sections/origins.h"
#include "reports/sections/ranking.h"
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
  Table table{
      .id = "rates",
      .title = "Rates from tables",
      .reading = "",
      .caption = fmt::format(
          "Tuned: the best of a grid, tried on this {} on seeds that no result uses. Published: a "
          "paper’s. All others run as requested, or with their defaults. Edge: the best value is "
          "the first or last of its grid, so a better one may lie beyond. Never: no value reached "
          "the tolerance in tuning. One value, best of 3, of all: the expected score of the best "
          "of that many values of the grid: 1 is the least work of all its values, 0 at least 64 "
          "times as much; mean over {}s.",
          setting_noun(c), setting_noun(c)),
      .columns = {"optimizer", n_column(c), "tuned", "published", "values chosen", "at an edge",
                  "never", "one value", "best of 3", "of all"}};
  for (const Rates& rates : all) {
    if (rates.is_empty()) continue;
    const std::vector<Real> curve = best_of_curve(rates);
    constexpr std::size_t kThird = 2;
    std::string values;
    if (rates.most > 0)
      values = rates.least == rates.most
                   ? figure(rates.most)
                   : fmt::format("{}–{}", figure(rates.least), figure(rates.most));
    table.rows.push_back({optimizer_text(c, rates.optimizer), count_cell(rates.settings),
                          count_cell(rates.tuned.size()), count_cell(rates.published), values,
                          count_cell(rates.at_edge), count_cell(rates.never), score_cell(curve, 0),
                          score_cell(curve, kThird),
                          score_cell(curve, curve.empty() ? 0 : curve.size() - 1)});
    table.row_topics.push_back({.optimizer = rates.optimizer});
  }
  return table;
}

Plot best_of_plot(const Comparison& c, const std::vector<Rates>& all) {
  Plot plot{.id = "plot-best-of",
            .title = "Gain of tuning: the best of b values",
            .reading = "",
            .caption = fmt::format(
                "Expected score of the best of b values sampled from the grid of a method: 1 is "
                "the least work of all its values, and 0 at least 64 times as much, or unsolved; "
                "mean over the "
                "{}s it was tuned on, on tuning seeds. A flat line needs no tuning; its end is "
                "the share of {}s that some value solves. The first {} methods with grids.",
                setting_noun(c), setting_noun(c), kMostLines),
            .x_label = "values tried, b",
            .y_label = "expected score of the best"};
  Real steepest = -1;
  std::string most;
  for (const Rates& rates : all) {
    const std::vector<Real> curve = best_of_curve(rates);
    if (curve.size() < 2 || plot.series.size() == kMostLines) continue;
    PlotSeries line{rates.optimizer, optimizer_text(c, rates.optimizer), {}, curve, {}, {}};
    for (std::size_t b = 1; b <= curve.size(); ++b) line.x.push_back(static_cast<Real>(b));
    if (curve.back() - curve.front() > steepest) {
      steepest = curve.back() - curve.front();
      most = fmt::format("{}, from {:.2f} with one value to {:.2f} with {}", line.name,
                         curve.front(), curve.back(), curve.size());
    }
    plot.series.push_back(std::move(line));
  }
  if (!most.empty()) plot.reading = fmt::format("Tuning gains most for {}.", most);
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
  if (rows == 0) return "";
  return fmt::format(
      "The best value is at an edge of its grid for {} of {}, and for {} of them no value reached "
      "the tolerance in tuning.",
      edges, counted(rows, "tuned rate"), never);
}

// Methods whose sheets tell that they have no option to tune; older sheets do not tell.
std::size_t untunable(const Comparison& c, const std::set<std::string>& methods) {
  std::set<std::string> tunable;
  for (const OptimizerAxis& axis : c.optimizers)
    if (axis.sheet != nullptr && !axis.sheet->tunable.empty()) tunable.insert(axis.method);
  return tunable.empty() ? 0 : methods.size() - tunable.size();
}

std::vector<Rates> all_rates(const Comparison& c) {
  std::vector<Rates> all;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) all.push_back(rates_of(c, s));
  return all;
}

}  // namespace

std::string rates_text(const Comparison& c) {
  std::set<std::string> methods, tuned, published;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const std::string& method = c.optimizers[s].method;
    methods.insert(method);
    for (std::size_t p = 0; p < c.problems.size(); ++p) {
      const Origin origin = origin_of(c, p, s);
      if (origin == Origin::tuned) tuned.insert(method);
      if (origin == Origin::published) published.insert(method);
    }
  }
  if (tuned.empty() && published.empty()) return "";
  for (const std::string& method : tuned) published.erase(method);
  const std::size_t fixed = untunable(c, methods);
  return fmt::format(
      "Methods in total: {}; {} {} rates tuned on the same {}s with other seeds{}; the others run "
      "as requested or with their defaults{}.",
      methods.size(), tuned.size(), tuned.size() == 1 ? "has" : "have", setting_noun(c),
      published.empty() ? "" : fmt::format(", and {} published ones", published.size()),
      fixed == 0 ? "" : fmt::format(", {} with nothing to tune", fixed));
}

Section tuning_section(const Comparison& c) {
  Section section{.id = "tuning",
                  .title = "Origin of the rates",
                  .otherwise =
                      "No run in this report used a table of rates: all methods run as requested, "
                      "or with their defaults."};
  const std::vector<Rates> all = all_rates(c);
  if (const std::string text = rates_text(c); !text.empty()) {
    section.readings.push_back({"", text});
    if (const std::string edges = edges_text(all); !edges.empty())
      section.readings.push_back({"", edges});
    section.tables.push_back(rates_table(c, all));
    if (Plot plot = best_of_plot(c, all); !plot.series.empty())
      section.plots.push_back(std::move(plot));
  } else if (std::ranges::any_of(
                 c.runs, [](const Run& run) { return !run.record->request.rates.empty(); })) {
    section.readings.push_back(
        {"",
         "These runs used tables of rates, but the results do not contain the values that were "
         "tried."});
  }
  if (Table both = tuned_and_defaults_table(c); !both.rows.empty())
    section.tables.push_back(std::move(both));
  return section;
}

// The same methods at the rates of tables and at their defaults: what tuning changed where it
// counts.

namespace {

// One method at rates of a table and at its defaults, on the settings that both were run on.
struct SideBySide {
  std::size_t tuned = 0, plain = 0;  // optimizers
  std::size_t n = 0, solved = 0, solved_plain = 0;
  Pairing pairing;  // of single settings
};

const Request& request_of(const Comparison& c, const Cell& cell) {
  return c.runs[cell.runs.front()].record->request;
}

bool has_rates(const Comparison& c, std::size_t s) {
  return std::ranges::any_of(c.cells, [&](const auto& row) {
    const Cell& cell = row[s];
    return cell.is_measured() && !request_of(c, cell).rates.empty() &&
           request_of(c, cell).optimizer.spec != request_of(c, cell).optimizer.name;
  });
}

bool is_at_defaults(const Comparison& c, std::size_t s) {
  return std::ranges::all_of(c.cells, [&](const auto& row) {
    const Cell& cell = row[s];
    return !cell.is_measured() ||
           request_of(c, cell).optimizer.spec == request_of(c, cell).optimizer.name;
  });
}

std::vector<SideBySide> pairs_of(const Comparison& c) {
  const Costs costs = median_costs(c, kTightest);
  Families settings;
  for (std::size_t p = 0; p < costs.size(); ++p) settings.push_back({p});
  std::vector<SideBySide> pairs;
  for (std::size_t a = 0; a < c.optimizers.size(); ++a)
    for (std::size_t b = 0; b < c.optimizers.size(); ++b) {
      const bool is_pair = a != b && c.optimizers[a].method == c.optimizers[b].method;
      if (!is_pair || !has_rates(c, a) || !is_at_defaults(c, b)) continue;
      SideBySide pair{.tuned = a, .plain = b, .pairing = pairing_of(costs, settings, a, b)};
      for (const auto& row : costs) {
        if (!row[a] || !row[b]) continue;
        ++pair.n;
        pair.solved += *row[a] < kNever;
        pair.solved_plain += *row[b] < kNever;
      }
      if (pair.n > 0) pairs.push_back(std::move(pair));
    }
  return pairs;
}

std::string factor_text(Real doublings) {
  const Real edge = std::log2(kProfileEnd);
  if (std::abs(doublings) >= edge) return doublings < 0 ? "≤ 1/64" : "≥ 64";
  return fmt::format("{:.2g}", std::exp2(doublings));
}

}  // namespace

Table tuned_and_defaults_table(const Comparison& c) {
  const std::vector<SideBySide> pairs = pairs_of(c);
  Table table{.id = "tuned-and-defaults",
              .title = "Defaults and tuned, side by side",
              .reading = "",
              .caption = fmt::format(
                  "The same method with the rates of tables and with its defaults, on the {}s "
                  "that it ran on with both: how many each solves to {}, on how many tuned needs "
                  "less {} and on "
                  "how many more, and tuned over default, 2 to the median of the logarithms of "
                  "these ratios where one of the two solves.",
                  setting_noun(c), tau_name(c), counted_name(c)),
              .columns = {"optimizer", n_column(c), "solved, tuned", "solved, defaults",
                          "less : more", "tuned over default"}};
  for (const SideBySide& pair : pairs) {
    const Real middle = median_of(pair.pairing.doublings);
    table.rows.push_back({c.optimizers[pair.plain].method, count_cell(pair.n),
                          count_cell(pair.solved), count_cell(pair.solved_plain),
                          fmt::format("{} : {}", pair.pairing.wins, pair.pairing.losses),
                          pair.pairing.doublings.empty()
                              ? TableCell("")
                              : TableCell(factor_text(middle), {{"doublings", middle}})});
    table.row_topics.push_back({.method = c.optimizers[pair.plain].method});
  }
  const auto better = std::ranges::count_if(
      pairs, [](const SideBySide& pair) { return pair.solved > pair.solved_plain; });
  const auto worse = std::ranges::count_if(
      pairs, [](const SideBySide& pair) { return pair.solved < pair.solved_plain; });
  table.reading = fmt::format(
      "Tuned, {} of {} methods solve more {}s than at their defaults, and {} solve fewer.", better,
      pairs.size(), setting_noun(c), worse);
  return table;
}

}  // namespace isoline::reports
