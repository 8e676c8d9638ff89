// The fit of a user's own problem: the first section of its report.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

#include "core/numbers.h"
#include "core/results/uncertainty.h"
#include "core/seeds.h"
#include "reports/sections/answers.h"
#include "reports/sections/drawings.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// A run with its data and its point, both whole.
bool is_fit(const Run& run) {
  const Record& record = *run.record;
  return record.fit && record.answer && !record.answer->point(kReturned).empty() &&
         std::isfinite(record.summary.loss) && !run.is_repeated;
}

// The fits of a problem to each of its data sets, by their least seeds: losses on other data do not
// compare.
std::vector<std::vector<const Run*>> data_sets_of(const Comparison& c, std::size_t problem) {
  std::vector<const Run*> fits;
  for (const Run& run : c.runs)
    if (run.problem == problem && is_fit(run)) fits.push_back(&run);
  std::ranges::stable_sort(fits, {}, &Run::seed);
  std::vector<std::vector<const Run*>> sets;
  for (const Run* fit : fits) {
    const auto same = std::ranges::find_if(sets, [&](const auto& set) {
      return set[0]->record->fit->target == fit->record->fit->target;
    });
    if (same != sets.end())
      same->push_back(fit);
    else
      sets.push_back({fit});
  }
  return sets;
}

// Nothing if the fit was not profiled.
const std::vector<LikelihoodProfile>* profiles_of(const Comparison& c, const Record& record) {
  const auto found =
      std::ranges::find(c.study->profiles, record.cell, &results::ProfiledCell::cell);
  return found == c.study->profiles.end() ? nullptr : &found->profiles;
}

std::vector<const Run*> by_loss(const Comparison& c, std::vector<const Run*> fits) {
  std::ranges::stable_sort(fits, {}, [](const Run* run) { return run->record->summary.loss; });
  // Where losses differ by noise, confirmed minima come first, among them those with profiles.
  constexpr Real kNoise = 1e-5;
  const Real most = (1 + kNoise) * fits[0]->record->summary.loss;
  const auto end =
      std::ranges::find_if(fits, [&](const Run* run) { return run->record->summary.loss > most; });
  std::stable_sort(fits.begin(), end, [&](const Run* a, const Run* b) {
    const auto rank = [&](const Run* run) {
      return doubt_of(*run->record) == Doubt::not_minimum ? 2 : !profiles_of(c, *run->record);
    };
    return rank(a) < rank(b);
  });
  return fits;
}

Table parameters_table(const std::string& problem, const Record& record) {
  const AnswerPoints& answer = *record.answer;
  const std::span<const Real> x = answer.point(kReturned);
  const bool is_known = doubt_of(record) == Doubt::none;
  Table table =
      is_known ? worded_table("fit-parameters", problem, record.uncertainty->degrees_of_freedom)
               : worded_table("fit-values", problem);
  const auto intervals = is_known ? intervals_of(record) : std::vector<XInterval>();
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::vector<TableCell> row = {
        answer.name(i), answer.unit(i), {fmt::format("{:.7g}", x[i]), {{"x", x[i]}}}};
    const std::string bound = answer.bound(i);
    std::string note = bound.empty() ? "" : words("fit.held", bound);
    if (is_known && std::isfinite(intervals[i].half)) {
      const auto& [half, low, high] = intervals[i];
      row.push_back({fmt::format("{:.2g}", half), {{"half", half}}});
      row.push_back(number_cell("deviation", record.uncertainty->standard_deviation[i]));
      row.push_back({fmt::format("{:.5g} … {:.5g}", low, high), {{"low", low}, {"high", high}}});
    } else if (is_known) {
      if (note.empty()) note = words("fit.constant");
      row.insert(row.end(), 3, "");
    }
    row.emplace_back(note);
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table correlation_table(const std::string& problem, const Record& record) {
  Table table = worded_table("fit-correlation", problem);
  const auto& correlation = record.uncertainty->correlation;
  table.align = "l" + std::string(correlation.size(), 'r');
  for (std::size_t i = 0; i < correlation.size(); ++i) {
    table.columns.push_back(record.answer->name(i));
    table.rows.push_back({record.answer->name(i)});
    for (const Real value : correlation[i])
      table.rows.back().push_back(
          std::isfinite(value) ? TableCell{fmt::format("{:.2f}", value), {{"correlation", value}}}
                               : TableCell(""));
  }
  return table;
}

bool are_one_minimum(const Record& a, const Record& b) {
  constexpr Real kLoss = 1e-4, kX = 1e-2;
  if (!(std::abs(a.summary.loss - b.summary.loss) <=
        kLoss * std::min(a.summary.loss, b.summary.loss)))
    return false;
  const auto x = a.answer->point(kReturned), z = b.answer->point(kReturned);
  return std::ranges::equal(x, z, [&](Real one, Real other) {
    return std::abs(one - other) <= kX * std::max(std::abs(one), std::abs(other));
  });
}

Table basins_table(const std::string& problem, const std::vector<const Run*>& fits) {
  constexpr std::size_t kShown = 12;  // minima, and unknowns
  std::vector<std::pair<const Record*, std::size_t>> basins;
  for (const Run* run : fits) {
    if (doubt_of(*run->record) == Doubt::not_minimum) continue;
    const auto same = std::ranges::find_if(
        basins, [&](const auto& basin) { return are_one_minimum(*basin.first, *run->record); });
    if (same == basins.end())
      basins.emplace_back(run->record, 1);
    else
      ++same->second;
  }
  Table table = worded_table("fit-basins", problem);
  for (std::size_t i = 0; i < std::min(kShown, basins.size()); ++i) {
    const auto& [record, runs] = basins[i];
    const auto x = record->answer->point(kReturned);
    std::vector<std::string> values;
    for (std::size_t j = 0; j < std::min(kShown, x.size()); ++j)
      values.push_back(fmt::format("{} = {:.6g}", record->answer->name(j), x[j]));
    table.rows.push_back({count_cell(runs), number_cell("loss", record->summary.loss),
                          joined(values, ", ") + (x.size() > kShown ? ", …" : "")});
  }
  return table;
}

Table profiles_table(const std::string& problem, const std::vector<LikelihoodProfile>& profiles) {
  Table table = worded_table("fit-profiles", problem);
  for (const LikelihoodProfile& profile : profiles)
    table.rows.push_back({profile.name,
                          {fmt::format("{:.5g} … {:.5g}", profile.low, profile.high),
                           {{"low", profile.low}, {"high", profile.high}}},
                          joined(profile.messages, "; ")});
  return table;
}

// ±√((S − S_min)/s²) over the distance from the fit in standard deviations: straight where x ± t·s
// holds.
Plot profiles_plot(const std::string& problem, const Record& record,
                   const std::vector<LikelihoodProfile>& profiles) {
  Plot plot = worded_plot("plot-profiles", problem);
  plot.kind = Plot::Kind::lines;
  for (const LikelihoodProfile& profile : profiles) {
    PlotSeries line{.name = profile.name};
    for (std::size_t i = 0; i < record.uncertainty->x.size(); ++i) {
      const Real s = record.uncertainty->standard_deviation[i], x = record.uncertainty->x[i];
      if (record.answer->name(i) != profile.name || !(s > 0)) continue;
      for (std::size_t j = 0; j < profile.value.size(); ++j) {
        const Real distance = (profile.value[j] - x) / s;
        line.x.push_back(distance);
        line.y.push_back(std::copysign(std::sqrt(std::max<Real>(profile.rise[j], 0)), distance));
      }
    }
    if (line.x.size() > 1 && plot.series.size() < kMostLines)
      plot.series.push_back(std::move(line));
  }
  return plot;
}

// Empty where none failed.
Table failures_table(const std::string& problem, const std::vector<const Run*>& runs) {
  constexpr std::size_t kShown = 12;
  std::map<std::string, std::size_t> counts;
  for (const Run* run : runs)
    if (run->record->failures)
      for (const std::string& reason : run->record->failures->reasons) ++counts[reason];
  if (counts.empty()) return {};
  std::vector<std::pair<std::string, std::size_t>> order(counts.begin(), counts.end());
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [](const auto& each) { return each.second; });
  Table table = worded_table("fit-failures", problem);
  for (std::size_t i = 0; i < std::min(kShown, order.size()); ++i)
    table.rows.push_back({count_cell(order[i].second), order[i].first});
  return table;
}

// The option `axis` of a fit, as its words.
std::vector<std::string> axis_of(const Record& record) {
  const std::string text = record.request.problem.options.text("axis");
  const auto cells = cells_of_line(text);
  return {cells.begin(), cells.end()};
}

Plot fit_plot(const std::string& problem, const Record& record, bool is_of_residuals) {
  const FitData& fit = *record.fit;
  Plot plot =
      is_of_residuals ? worded_plot("plot-residuals", problem) : worded_plot("plot-fit", problem);
  plot.kind = Plot::Kind::lines;
  const std::vector<std::string> axis = axis_of(record);  // two names, and the places
  const bool has_places = axis.size() == fit.target.size() + 2;
  std::vector<Real> places;
  for (std::size_t i = 0; i < fit.target.size(); ++i)
    places.push_back(has_places ? number_in(axis[i + 2]).value_or(Real(i + 1)) : Real(i + 1));
  if (has_places) plot.x_label = axis[0];
  if (axis.size() > 1)
    plot.y_label = is_of_residuals ? fmt::format("{0} − {0}*", axis[1]) : axis[1];
  std::vector<std::size_t> order(fit.target.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](std::size_t i) { return places[i]; };
  std::ranges::stable_sort(order, {}, place);
  const bool has_one_y = [&] {  // at each place; several sensors have no common line
    for (std::size_t i = 1; i < order.size(); ++i)
      if (place(order[i]) == place(order[i - 1]) && fit.y[order[i]] != fit.y[order[i - 1]])
        return false;
    return true;
  }();
  PlotSeries points{.name = words(is_of_residuals ? "plot-residuals.residual" : "plot-fit.data"),
                    .are_points = true},
      line{.name = words(is_of_residuals ? "plot-residuals.zero" : "plot-fit.fit"),
           .are_points = !has_one_y && !is_of_residuals};
  for (const std::size_t i : order) {
    const Real at = is_of_residuals ? fit.y[i] - fit.target[i] : fit.target[i];
    points.x.push_back(place(i));
    points.y.push_back(at);
    if (!fit.sigma.empty()) {
      points.low.push_back(at - fit.sigma[i]);
      points.high.push_back(at + fit.sigma[i]);
    }
    line.x.push_back(place(i));
    line.y.push_back(is_of_residuals ? 0 : fit.y[i]);
  }
  plot.series = {std::move(points), std::move(line)};
  return plot;
}

Plot calls_plot(const std::string& problem, const std::vector<const Run*>& fits,
                const Comparison& c) {
  Plot plot = worded_plot("plot-calls", problem);
  plot.kind = Plot::Kind::lines;
  plot.is_log_y = true;
  std::set<std::size_t> seen;
  for (const Run* run : fits) {
    if (seen.size() == kMostLines || !seen.insert(run->optimizer).second) continue;
    PlotSeries line = line_of(c, run->optimizer);
    const Curve& curve = run->record->curve;
    Real least = kNever;
    for (std::size_t i = 0; i < curve.loss.size(); ++i) {
      if (std::isfinite(curve.loss[i])) least = std::min(least, curve.loss[i]);
      if (!(least > 0 && least < kNever)) continue;
      line.x.push_back(Real(curve.work[i]));
      line.y.push_back(least);
    }
    if (line.x.size() > 1) plot.series.push_back(std::move(line));
  }
  return plot;
}

// Adds the fits to one data set, the best first. `runs`: these, and runs without a fit.
void add_data_set(Section& section, const Comparison& c, const std::vector<const Run*>& fits,
                  const std::vector<const Run*>& runs, const std::string& problem,
                  const std::string& suffix) {
  const Record& record = *fits[0]->record;
  std::string text = words("fit.summary", problem, optimizer_text(c, fits[0]->optimizer),
                           std::string(name_of(record.status)), record.summary.loss,
                           record.summary.work, record.fit->target.size());
  const Doubt doubt = doubt_of(record);
  if (doubt != Doubt::none) text += " " + doubt_text(record);
  if (const auto test = noise_test(record); test && doubt == Doubt::none)
    text += " " + words("fit.test", test->chi_square, test->freedom, test->p);
  if (!record.message.empty()) text += " " + words("fit.message", record.message);
  section.readings.push_back({"", text});
  std::vector<Table> tables = {parameters_table(problem, record)};
  if (doubt == Doubt::none && record.uncertainty->x.size() > 1)
    tables.push_back(correlation_table(problem, record));
  const auto* const profiles = doubt == Doubt::none ? profiles_of(c, record) : nullptr;
  if (profiles) tables.push_back(profiles_table(problem, *profiles));
  if (Table basins = basins_table(problem, fits); fits.size() > 1 && !basins.rows.empty())
    tables.push_back(std::move(basins));
  if (Table failures = failures_table(problem, runs); !failures.rows.empty())
    tables.push_back(std::move(failures));
  for (Table& table : tables) {
    table.id += suffix;
    section.tables.push_back(std::move(table));
  }
  for (Plot& plot : std::vector{fit_plot(problem, record, false), fit_plot(problem, record, true),
                                profiles ? profiles_plot(problem, record, *profiles) : Plot{},
                                calls_plot(problem, fits, c)}) {
    plot.id += suffix;
    if (!plot.series.empty()) section.plots.push_back(plot);
  }
}

}  // namespace

Section fit_section(const Comparison& c) {
  constexpr std::size_t kMostSets = 6;  // data sets of a problem
  Section section = worded_section("fit");
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const auto sets = data_sets_of(c, p);
    std::vector<const Run*> runs;
    for (const Run& run : c.runs)
      if (run.problem == p && !run.is_repeated) runs.push_back(&run);
    for (std::size_t d = 0; d < std::min(kMostSets, sets.size()); ++d) {
      const std::string problem =
          problem_name(c.problems[p]) +
          (sets.size() > 1 ? words("fit.data-set", seed_text(sets[d][0]->seed)) : "");
      add_data_set(section, c, by_loss(c, sets[d]), sets.size() > 1 ? sets[d] : runs, problem,
                   sets.size() > 1 ? fmt::format("-{}-{}", p, d) : fmt::format("-{}", p));
    }
    if (sets.size() > kMostSets)
      section.readings.push_back({"", words("fit.more-sets", sets.size() - kMostSets)});
  }
  if (const std::string unchecked = unchecked_text(c); !section.is_empty() && !unchecked.empty())
    section.readings.push_back({"", unchecked});
  return section;
}

}  // namespace isoline::reports
