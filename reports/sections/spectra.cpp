// The singular values of J along runs that kept them, and two options that were swept together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "core/errors.h"
#include "core/learning_options.h"
#include "core/spec.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kNone = std::numeric_limits<Real>::quiet_NaN();
constexpr Real kVisible = 1e-6;  // of the largest, the usual cut-off

// The run of the least seed that kept spectra.
struct Seen {
  std::size_t optimizer;
  std::string name;
  const Spectrum* spectrum;

  const std::vector<Real>& first() const { return spectrum->sigma.front(); }
  const std::vector<Real>& last() const { return spectrum->sigma.back(); }
};

bool is_drawable(const std::vector<Real>& sigma) {
  return std::ranges::any_of(sigma, [](Real one) { return one > 0 && std::isfinite(one); });
}

// The best first.
std::vector<Seen> seen_on(const Comparison& c, std::size_t problem) {
  std::vector<Seen> all;
  for (const std::size_t s : ranking(c, problem))
    for (const std::size_t run : c.cell(problem, s).runs) {
      const auto& spectrum = c.runs[run].record->spectrum;
      if (!spectrum || spectrum->sigma.empty() || spectrum->sigma.front().empty()) continue;
      if (is_drawable(spectrum->sigma.front()) && is_drawable(spectrum->sigma.back()))
        all.push_back({s, optimizer_text(c, s), &*spectrum});
      break;
    }
  return all;
}

// σ₁/σ_r; nothing where the smallest is 0.
Real condition(const std::vector<Real>& sigma) {
  return sigma.back() > 0 ? sigma.front() / sigma.back() : kNone;
}

std::ptrdiff_t visible(const std::vector<Real>& sigma) {
  return std::ranges::count_if(sigma, [&](Real one) { return one > kVisible * sigma[0]; });
}

PlotSeries values(std::string name, const std::vector<Real>& sigma) {
  PlotSeries line{.optimizer = {}, .name = std::move(name)};
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    line.x.push_back(Real(i + 1));
    line.y.push_back(sigma[i] > 0 ? sigma[i] : kNone);
  }
  return line;
}

// The first curves of each plot.
constexpr std::size_t kMostSeen = 4;

Plot values_plot(Plot plot, const std::vector<Seen>& seen) {
  plot.series.push_back(values("at the start", seen[0].first()));
  for (const Seen& one : std::span(seen).first(std::min(seen.size(), kMostSeen)))
    plot.series.push_back(values(
        fmt::format("{}, iteration {}", one.name, one.spectrum->iterations.back()), one.last()));
  plot.reading = words("plot-spectrum.reading", visible(seen[0].first()), seen[0].first().size(),
                       seen[0].name, visible(seen[0].last()));
  return plot;
}

Plot conditions_plot(Plot plot, const std::vector<Seen>& seen) {
  for (const Seen& one : std::span(seen).first(std::min(seen.size(), kMostSeen))) {
    PlotSeries& line =
        plot.series.emplace_back(PlotSeries{one.optimizer, one.name, {}, {}, {}, {}});
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

// First and last, a row each.
Table spectra_table(const Comparison& c, std::size_t p, const std::vector<Seen>& seen) {
  Table table = worded_table("spectrum", problem_name(c.problems[p]));
  table.id = fmt::format("spectrum-{}", p);
  for (const Seen& one : seen)
    for (const bool is_last : {false, true}) {
      const std::vector<Real>& sigma = is_last ? one.last() : one.first();
      const auto& iterations = one.spectrum->iterations;
      const Real ratio = condition(sigma);
      table.rows.push_back({one.name,
                            std::to_string(is_last ? iterations.back() : iterations.front()),
                            number_cell("largest", sigma.front()),
                            number_cell("smallest", sigma.back()),
                            {std::isnan(ratio) ? "inf" : figure(ratio), {{"condition", ratio}}},
                            fmt::format("{} of {}", visible(sigma), sigma.size())});
      table.row_topics.push_back({.optimizer = one.optimizer, .problem = p});
    }
  return table;
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
      return empty;
    };
    section.plots.push_back(values_plot(plot("plot-spectrum"), seen));
    section.plots.push_back(conditions_plot(plot("plot-conditioning"), seen));
    section.tables.push_back(spectra_table(c, p, seen));
  }
  return section;
}

// Two options swept together, as heat maps: where the best stands, and how far around it is good.

namespace {

constexpr std::size_t kMostGrids = 12;

// A sweep of one problem and one optimizer by name. Its options belong to the problem, the
// optimizer, or a part inside one of them: "batch", "kappa", "network-optimizer.rate".
struct SweepGrid {
  std::string problem, optimizer;
  std::string row, column;  // options
  std::vector<Real> rows, columns;
  std::vector<std::vector<std::vector<std::size_t>>> runs;  // indices, [row][column]
  std::int64_t iterations = 0;                              // of each run, or
  std::int64_t samples = 0;                                 // where batches differ in size
};

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
};
using Entries = std::vector<Entry>;

// "network-optimizer" is a name and "network-optimizer.rate" a number of "adam[rate=1e-3]".
void add_inner(const std::string& name, const std::string& text, Entry& out) {
  out.texts[name] = text;
  if (name_of_spec(text) == text) return;
  try {
    for (const auto& [option, value] : parse_spec(text).options)
      out.add(name + "." + option, value);
    out.texts[name] = name_of_spec(text);
  } catch (const UsageError&) {  // a text of another kind
  }
}

void add(const Component& component, Entry& out) {
  for (const NamedOption& option : component.options) {
    const std::string* text = std::get_if<std::string>(&option.value);
    if (text != nullptr) {
      add_inner(option.name, *text, out);
      continue;
    }
    out.texts[option.name] = option_text(option.value);
    if (const Real* real = std::get_if<Real>(&option.value)) out.numbers[option.name] = *real;
    if (const Index* whole = std::get_if<Index>(&option.value))
      out.numbers[option.name] = static_cast<Real>(*whole);
  }
}

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
    add(request.problem, entry);
    add(request.optimizer, entry);
    all[{request.problem.name, request.optimizer.name}].push_back(std::move(entry));
  }
  return all;
}

std::vector<std::string> swept_options(const Entries& entries) {
  std::map<std::string, std::set<Real>> values;
  for (const Entry& entry : entries)
    for (const auto& [name, number] : entry.numbers) values[name].insert(number);
  std::vector<std::string> names;
  for (const auto& [name, each] : values)
    if (each.size() > 1) names.push_back(name);
  return names;
}

SweepGrid grid_of(const std::vector<const Entry*>& entries, std::string row, std::string column) {
  const auto values = [&](const std::string& name) {
    std::set<Real> all;
    for (const Entry* entry : entries) all.insert(entry->numbers.at(name));
    return std::vector<Real>(all.begin(), all.end());
  };
  if (values(row).size() > values(column).size()) std::swap(row, column);
  SweepGrid grid{.row = row, .column = column, .rows = values(row), .columns = values(column)};
  grid.runs.assign(grid.rows.size(), std::vector<std::vector<std::size_t>>(grid.columns.size()));
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
  std::size_t filled = 0;
  for (const auto& row : grid.runs)
    for (const auto& cell : row) filled += !cell.empty();
  return grid.rows.size() >= kRows && grid.columns.size() >= kColumns &&
         4 * filled >= 3 * cells_of(grid);
}

// Groups of runs that share all but two options, and their length: in iterations, or in samples.
void add_grids(const Entries& entries, const std::string& first, const std::string& second,
               bool is_by_samples, std::vector<SweepGrid>& out) {
  std::map<std::string, std::vector<const Entry*>> groups;
  for (const Entry& entry : entries) {
    if (!entry.numbers.contains(first) || !entry.numbers.contains(second)) continue;
    std::string key = std::to_string(is_by_samples ? entry.samples : entry.iterations);
    for (const auto& [name, text] : entry.texts)
      if (name != first && name != second) key += fmt::format(",{}={}", name, text);
    groups[key].push_back(&entry);
  }
  for (const auto& [key, group] : groups) {
    SweepGrid grid = grid_of(group, first, second);
    (is_by_samples ? grid.samples : grid.iterations) =
        is_by_samples ? group[0]->samples : group[0]->iterations;
    if (is_full_enough(grid)) out.push_back(std::move(grid));
  }
}

// Grids of at least two by three values with runs in three quarters of their cells, the largest
// first: settings that differ in nothing else.
std::vector<SweepGrid> sweep_grids(const Comparison& c) {
  std::vector<SweepGrid> all;
  for (const auto& [names, entries] : entries_of(c)) {
    const std::vector<std::string> options = swept_options(entries);
    const std::size_t before = all.size();
    for (std::size_t a = 0; a < options.size(); ++a)
      for (std::size_t b = a + 1; b < options.size(); ++b) {
        add_grids(entries, options[a], options[b], false, all);
        if (options[a] == kBatchOption || options[b] == kBatchOption)
          add_grids(entries, options[a], options[b], true, all);
      }
    for (std::size_t i = before; i < all.size(); ++i)
      std::tie(all[i].problem, all[i].optimizer) = names;
  }
  std::ranges::stable_sort(all, std::greater(), cells_of);
  return all;
}

// Medians over seeds, [row][column]; nothing where nothing was planned.
struct Medians {
  std::vector<std::vector<std::optional<Spread>>> of;
  Real least = kNever;
  std::size_t row = 0, column = 0;  // where the least stands
  std::size_t measured = 0, near = 0;
  std::size_t fewest = 0, most = 0;  // seeds
  bool is_of_x = false;              // errors in x, else losses
  std::string best;                  // its optimizer and problem
};

// At the end of a run; infinite where it failed or is not finite.
Real end_of(const Run& run, bool is_of_x) {
  const Summary& summary = run.record->summary;
  const Real value = is_of_x ? summary.x_error : summary.loss;
  return is_failure(run.record->status) || !std::isfinite(value) ? kNever : value;
}

Medians medians_of(const Comparison& c, const SweepGrid& grid) {
  Medians all{.fewest = c.runs.size()};
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    all.of.emplace_back(grid.columns.size());
    for (std::size_t k = 0; k < grid.columns.size(); ++k) {
      const std::vector<std::size_t>& runs = grid.runs[r][k];
      if (runs.empty()) continue;
      if (all.measured++ == 0) all.is_of_x = c.runs[runs[0]].aim == Aim::x;
      all.fewest = std::min(all.fewest, runs.size());
      all.most = std::max(all.most, runs.size());
      std::vector<Real> ends;
      for (const std::size_t run : runs) ends.push_back(end_of(c.runs[run], all.is_of_x));
      const Spread& spread = all.of[r][k].emplace(spread_of(std::move(ends)));
      if (!(spread.median < all.least)) continue;
      const Request& request = c.runs[runs[0]].record->request;
      std::tie(all.least, all.row, all.column) = std::tuple{spread.median, r, k};
      all.best = shown_spec(request.optimizer.spec) + " on " + shown_spec(request.problem.spec);
    }
  }
  for (const auto& row : all.of)
    for (const auto& cell : row) all.near += cell && cell->median <= 2 * all.least;
  return all;
}

TableCell cell_of(const std::optional<Spread>& spread, Real least) {
  if (!spread) return "";
  TableCell cell{reached_figure(spread->median),
                 {{"median", spread->median}, {"n", Real(spread->n)}}};
  if (spread->median < kNever) cell.shade = shade_of(spread->median, least);
  cell.is_best = spread->median == least && least < kNever;
  return cell;
}

Table heat_map(const Comparison& c, const SweepGrid& grid, std::size_t number) {
  const Medians medians = medians_of(c, grid);
  Table table = worded_table("sweep", grid.optimizer, grid.problem, grid.row, grid.column);
  table.id = fmt::format("sweep-{}", number);
  table.reading =
      medians.least == kNever
          ? words("sweep.none")
          : words("sweep.reading", medians.least, grid.row, grid.rows[medians.row], grid.column,
                  grid.columns[medians.column], medians.near, medians.measured);
  const std::string fewest =
      medians.fewest == medians.most ? "" : fmt::format("{} to ", medians.fewest);
  // An option of all of its runs that is not swept stands in the spec of the best.
  table.caption = words("sweep.shown", medians.is_of_x ? "Error in x" : "Loss",
                        fewest + counted(medians.most, "seed"),
                        grid.samples > 0 ? fmt::format("{} samples", grid.samples)
                                         : fmt::format("{} iterations", grid.iterations),
                        medians.best.empty() ? "" : fmt::format(" The best: {}.", medians.best));
  for (const Real value : grid.columns) table.columns.push_back(figure(value));
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row.push_back(figure(grid.rows[r]));
    for (const auto& cell : medians.of[r]) row.push_back(cell_of(cell, medians.least));
  }
  return table;
}

}  // namespace

Section sweeps_section(const Comparison& c) {
  Section section = worded_section("sweeps");
  const std::vector<SweepGrid> grids = sweep_grids(c);
  for (std::size_t i = 0; i < std::min(grids.size(), kMostGrids); ++i)
    section.tables.push_back(heat_map(c, grids[i], i + 1));
  if (grids.size() > kMostGrids)
    section.lead += " " + words("sweeps.largest", kMostGrids, grids.size());
  return section;
}

}  // namespace isoline::reports
