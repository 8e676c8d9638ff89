// The singular values of J along runs that kept them, with the standard deviations of x, and two
// options that were swept together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "core/errors.h"
#include "core/options.h"
#include "core/spec.h"
#include "reports/sections/drawings.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kVisible = 1e-6;  // of the largest, the usual cut-off

// The run of the least seed that kept spectra.
struct Seen {
  std::size_t optimizer;
  std::string name, method;
  const Spectrum* spectrum;

  const std::vector<Real>& first() const { return spectrum->sigma.front(); }
  const std::vector<Real>& last() const { return spectrum->sigma.back(); }
};

// The best first.
std::vector<Seen> seen_on(const Comparison& c, std::size_t problem) {
  std::vector<Seen> all;
  for (const std::size_t s : ranking(c, problem))
    for (const std::size_t run : c.cell(problem, s).runs) {
      const auto& spectrum = c.runs[run].record->spectrum;
      if (!spectrum || spectrum->sigma.empty() || spectrum->sigma.front().empty()) continue;
      const auto is_drawn = [](Real one) { return one > 0 && std::isfinite(one); };
      if (std::ranges::any_of(spectrum->sigma.front(), is_drawn) &&
          std::ranges::any_of(spectrum->sigma.back(), is_drawn))
        all.push_back({s, optimizer_text(c, s), c.optimizers[s].method, &*spectrum});
      break;
    }
  return all;
}

// σ₁/σ_r, without a value if the smallest is 0.
Real condition(const std::vector<Real>& sigma) {
  return sigma.back() > 0 ? sigma.front() / sigma.back() : kUnknown;
}

std::ptrdiff_t visible(const std::vector<Real>& sigma) {
  return std::ranges::count_if(sigma, [&](Real one) { return one > kVisible * sigma[0]; });
}

PlotSeries values(std::string name, const std::vector<Real>& sigma, std::string method = {}) {
  PlotSeries line{.name = std::move(name), .method = std::move(method)};
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    line.x.push_back(Real(i + 1));
    line.y.push_back(sigma[i] > 0 ? sigma[i] : kUnknown);
  }
  return line;
}

// The first curves of each plot.
constexpr std::size_t kMostSeen = 4;

Plot values_plot(Plot plot, const std::vector<Seen>& seen) {
  plot.series.push_back(values("at the start", seen[0].first()));
  for (const Seen& one : std::span(seen).first(std::min(seen.size(), kMostSeen)))
    plot.series.push_back(
        values(fmt::format("{}, iteration {}", one.name, one.spectrum->iterations.back()),
               one.last(), one.method));
  plot.reading = words("plot-spectrum.reading", visible(seen[0].first()), seen[0].first().size(),
                       seen[0].name, visible(seen[0].last()));
  return plot;
}

Plot conditions_plot(Plot plot, const std::vector<Seen>& seen) {
  for (const Seen& one : std::span(seen).first(std::min(seen.size(), kMostSeen))) {
    PlotSeries& line = plot.series.emplace_back(
        PlotSeries{.optimizer = one.optimizer, .name = one.name, .method = one.method});
    for (std::size_t k = 0; k < one.spectrum->sigma.size(); ++k) {
      line.x.push_back(1 + Real(one.spectrum->iterations[k]));
      line.y.push_back(condition(one.spectrum->sigma[k]));
    }
  }
  const Real first = condition(seen[0].first()), last = condition(seen[0].last());
  const bool is_known = !std::isnan(first) && !std::isnan(last);
  plot.reading = words(is_known ? "plot-conditioning.reading" : "plot-conditioning.singular", first,
                       last, seen[0].name);
  return plot;
}

}  // namespace

Section spectra_section(const Comparison& c) {
  Section section = worded_section("spectra");
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const std::vector<Seen> seen = seen_on(c, p);
    if (seen.empty()) continue;
    const auto plot = [&](const std::string& key) {
      Plot empty = worded_plot(key, problem_name(c.problems[p]));
      empty.kind = Plot::Kind::lines;
      empty.id += fmt::format("-{}", p);
      empty.is_log_x = empty.is_log_y = true;
      empty.topic = {.problem = p};
      return empty;
    };
    section.plots.push_back(values_plot(plot("plot-spectrum"), seen));
    section.plots.push_back(conditions_plot(plot("plot-conditioning"), seen));
  }
  section.tables = uncertainty_tables(c);
  return section;
}

// Heat maps of two options that were varied together.

namespace {

// Options of a run, and of components inside it, as texts; those that are numbers.
struct Entry {
  std::size_t run;
  std::int64_t iterations, samples;  // allowed
  std::map<std::string, std::string> texts = {};
  std::map<std::string, Real> numbers = {};

  void add(const std::string& name, const std::string& text) {
    texts[name] = text;
    char* end = nullptr;
    const Real value = std::strtod(text.c_str(), &end);
    if (!text.empty() && *end == '\0') numbers[name] = value;
  }
  // "network-optimizer" is a name and "network-optimizer.rate" a number of "adam[rate=1e-3]".
  void add(const Component& component) {
    for (const NamedOption& option : component.options) {
      const std::string* text = std::get_if<std::string>(&option.value);
      texts[option.name] = text != nullptr ? *text : option_text(option.value);
      if (const Real* real = std::get_if<Real>(&option.value)) numbers[option.name] = *real;
      if (const Index* whole = std::get_if<Index>(&option.value))
        numbers[option.name] = static_cast<Real>(*whole);
      if (text == nullptr || name_of_spec(*text) == *text) continue;
      try {
        for (const auto& [inner, value] : parse_spec(*text).options)
          add(option.name + "." + inner, value);
        texts[option.name] = name_of_spec(*text);
      } catch (const UsageError&) {  // a text of another kind
      }
    }
  }
};
using Entries = std::vector<Entry>;

// By problem and optimizer.
std::map<std::pair<std::string, std::string>, Entries> entries_of(const Comparison& c) {
  std::map<std::pair<std::string, std::string>, Entries> all;
  for (std::size_t i = 0; i < c.runs.size(); ++i) {
    const Request& request = c.runs[i].record->request;
    if (c.runs[i].is_repeated || c.runs[i].record->status == Status::inapplicable) continue;
    const std::int64_t iterations = request.budget.iterations;
    const auto batch = static_cast<std::int64_t>(request.problem.options.number(kBatchOption, 1));
    const bool is_counted = batch > 0 && iterations < Budget{}.iterations;
    Entry entry{i, iterations, is_counted ? iterations * batch : iterations};
    entry.add(request.problem);
    entry.add(request.optimizer);
    all[{request.problem.name, request.optimizer.name}].push_back(std::move(entry));
  }
  return all;
}

// A sweep of one problem and one optimizer by name. Its options belong to the problem, the
// optimizer, or a part inside one of them: "batch", "kappa", "network-optimizer.rate".
struct SweepGrid {
  std::string problem, optimizer;
  std::string row, column;  // options
  std::vector<Real> rows, columns;
  std::vector<std::vector<Rows>> runs;  // [row][column]
  std::int64_t length = 0;              // of each run, in samples where batches differ in size
  bool is_of_samples = false;
};

SweepGrid grid_of(const std::vector<const Entry*>& entries, std::string row, std::string column) {
  const auto values = [&](const std::string& name) {
    std::set<Real> all;
    for (const Entry* entry : entries) all.insert(entry->numbers.at(name));
    return std::vector<Real>(all.begin(), all.end());
  };
  if (values(row).size() > values(column).size()) std::swap(row, column);
  SweepGrid grid{.row = row, .column = column, .rows = values(row), .columns = values(column)};
  grid.runs.assign(grid.rows.size(), std::vector<Rows>(grid.columns.size()));
  const auto place = [](const std::vector<Real>& all, Real value) {
    return static_cast<std::size_t>(std::ranges::lower_bound(all, value) - all.begin());
  };
  for (const Entry* entry : entries)
    grid.runs[place(grid.rows, entry->numbers.at(row))]
             [place(grid.columns, entry->numbers.at(column))]
                 .push_back(entry->run);
  return grid;
}

std::size_t cells_of(const SweepGrid& grid) { return grid.rows.size() * grid.columns.size(); }

bool is_full_enough(const SweepGrid& grid) {
  constexpr std::size_t kRows = 2, kColumns = 3;
  std::ptrdiff_t empty = 0;
  for (const auto& row : grid.runs) empty += std::ranges::count_if(row, &Rows::empty);
  return grid.rows.size() >= kRows && grid.columns.size() >= kColumns &&
         4 * static_cast<std::size_t>(empty) <= cells_of(grid);
}

// Groups of runs that share all but two options, and their length: in iterations, or in samples.
void add_grids(const Entries& entries, const std::string& first, const std::string& second,
               bool is_of_samples, std::vector<SweepGrid>& out) {
  const auto length = [=](const Entry& one) {
    return is_of_samples ? one.samples : one.iterations;
  };
  std::map<std::string, std::vector<const Entry*>> groups;
  for (const Entry& entry : entries) {
    if (!entry.numbers.contains(first) || !entry.numbers.contains(second)) continue;
    std::string key = std::to_string(length(entry));
    for (const auto& [name, text] : entry.texts)
      if (name != first && name != second) key += fmt::format(",{}={}", name, text);
    groups[key].push_back(&entry);
  }
  for (const auto& [key, group] : groups) {
    SweepGrid grid = grid_of(group, first, second);
    grid.length = length(*group[0]);
    grid.is_of_samples = is_of_samples;
    if (is_full_enough(grid)) out.push_back(std::move(grid));
  }
}

// Grids of at least two by three values with runs in three quarters of their cells, the largest
// first: settings that differ in nothing else.
std::vector<SweepGrid> sweep_grids(const Comparison& c) {
  std::vector<SweepGrid> all;
  for (const auto& [names, entries] : entries_of(c)) {
    std::map<std::string, std::set<Real>> values;
    for (const Entry& entry : entries)
      for (const auto& [name, number] : entry.numbers) values[name].insert(number);
    std::erase_if(values, [](const auto& option) { return option.second.size() < 2; });
    const std::size_t before = all.size();
    for (auto a = values.begin(); a != values.end(); ++a)
      for (auto b = std::next(a); b != values.end(); ++b) {
        add_grids(entries, a->first, b->first, false, all);
        if (a->first == kBatchOption || b->first == kBatchOption)
          add_grids(entries, a->first, b->first, true, all);
      }
    for (std::size_t i = before; i < all.size(); ++i)
      std::tie(all[i].problem, all[i].optimizer) = names;
  }
  std::ranges::stable_sort(all, std::greater(), cells_of);
  return all;
}

// Medians over seeds of the final values, infinite if a run failed or is not finite.
Table heat_map(const Comparison& c, const SweepGrid& grid, std::size_t number) {
  Table table = worded_table("sweep", grid.optimizer, grid.problem, grid.row, grid.column);
  table.id = fmt::format("sweep-{}", number);
  std::vector<std::vector<std::optional<Spread>>> medians;  // no value if no run was planned
  Real least = kNever;
  std::size_t best_row = 0, best_column = 0, measured = 0, near = 0;
  std::size_t fewest = c.runs.size(), most = 0;  // seeds
  bool is_of_x = false;
  std::string best;  // the spec of the best run contains options that were not varied
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    medians.emplace_back(grid.columns.size());
    for (std::size_t k = 0; k < grid.columns.size(); ++k) {
      const Rows& runs = grid.runs[r][k];
      if (runs.empty()) continue;
      if (measured++ == 0) is_of_x = c.runs[runs[0]].aim == Aim::x;
      fewest = std::min(fewest, runs.size());
      most = std::max(most, runs.size());
      const Spread& spread = medians[r][k].emplace(c.aggregate(runs, [&](const Run& run) {
        const Summary& summary = run.record->summary;
        const Real value = is_of_x ? summary.x_error : summary.loss;
        return is_failure(run.record->status) || !std::isfinite(value) ? kNever : value;
      }));
      if (!(spread.median < least)) continue;
      const Request& request = c.runs[runs[0]].record->request;
      std::tie(least, best_row, best_column) = std::tuple{spread.median, r, k};
      best = fmt::format(" The least value: {} on {}.", shown_spec(request.optimizer.spec),
                         shown_spec(request.problem.spec));
    }
  }
  for (const Real value : grid.columns) table.columns.push_back(figure(value));
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row.push_back(figure(grid.rows[r]));
    for (const auto& spread : medians[r]) {
      TableCell& cell = row.emplace_back("");
      if (!spread) continue;
      cell = {reached_figure(spread->median), {{"median", spread->median}, {"n", Real(spread->n)}}};
      const Run& first = c.runs[grid.runs[r][row.size() - 2][0]];
      cell.of = {first.problem, first.optimizer};
      if (spread->median < kNever) cell.shade = shade_of(spread->median, least);
      cell.is_best = spread->median == least && least < kNever;
      near += spread->median <= 2 * least;
    }
  }
  table.reading = least == kNever ? words("sweep.none")
                                  : words("sweep.reading", least, grid.row, grid.rows[best_row],
                                          grid.column, grid.columns[best_column], near, measured);
  table.caption =
      words("sweep.shown", is_of_x ? "Error in x" : "Loss",
            (fewest == most ? "" : fmt::format("{} to ", fewest)) + counted(most, "seed"),
            grid.length, grid.is_of_samples ? "samples" : "iterations", best);
  return table;
}

}  // namespace

Section sweeps_section(const Comparison& c) {
  constexpr std::size_t kMostGrids = 12;
  Section section = worded_section("sweeps");
  const std::vector<SweepGrid> grids = sweep_grids(c);
  for (std::size_t i = 0; i < std::min(grids.size(), kMostGrids); ++i)
    section.tables.push_back(heat_map(c, grids[i], i + 1));
  if (grids.size() > kMostGrids)
    section.lead += " " + words("sweeps.largest", kMostGrids, grids.size());
  return section;
}

}  // namespace isoline::reports
