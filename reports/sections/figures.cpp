// The panels of figures: the runs of each panel, and the data that it shows.
#include "reports/sections/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "core/results/statistics.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kPoints = 96;   // a line
constexpr std::size_t kMostRead = 8;  // methods that a sentence names

using Records = std::vector<const Record*>;

Records records_of(const Comparison& c, std::size_t problem, std::size_t optimizer) {
  Records records;
  for (const std::size_t run : c.cell(problem, optimizer).runs)
    if (!c.runs[run].record->curve.iteration.empty()) records.push_back(c.runs[run].record);
  return records;
}

void add_point(FigureLine& line, Real x, std::vector<Real> values) {
  if (values.empty()) return;
  const Spread y = spread_of(std::move(values));
  line.x.push_back(x);
  line.y.push_back(y.median);
  line.low.push_back(y.low);
  line.high.push_back(y.high);
}

// For every optimizer with runs on the problem, what `draw` makes of them; empty lines left out.
template <class Draw>
std::vector<FigureLine> lines_of(const Comparison& c, std::size_t problem, Draw draw) {
  std::vector<FigureLine> lines;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    const Records records = records_of(c, problem, s);
    FigureLine line{.optimizer = s};
    if (!records.empty()) draw(records, line);
    if (!line.x.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

std::string label(const Comparison& c, const FigureLine& line) {
  return shown_spec(c.optimizers[line.optimizer].brief);
}

// "At the end sip has 0.0129, adam 0.31, …": the last values, least first.
std::string ends_reading(const Comparison& c, std::vector<FigureLine> lines) {
  std::erase_if(lines, [](const FigureLine& line) { return !std::isfinite(line.y.back()); });
  std::ranges::sort(lines, {}, [](const FigureLine& line) { return line.y.back(); });
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < std::min(kMostRead, lines.size()); ++i) {
    const Real end = lines[i].y.back();
    parts.push_back(fmt::format("{}{} {}", label(c, lines[i]), i == 0 ? " has" : "", figure(end)));
  }
  return parts.empty() ? "" : words("figure.ends", joined(parts));
}

// "sip 0.5, adam 0.7": what `value` makes of each line.
template <class Value>
std::string read_lines(const Comparison& c, const std::vector<FigureLine>& lines, std::size_t most,
                       Value value) {
  std::vector<std::string> parts;
  for (const FigureLine& line : std::span(lines).first(std::min(most, lines.size())))
    parts.push_back(fmt::format("{} {}", label(c, line), figure(value(line))));
  return joined(parts);
}

const std::vector<Real>* series_of(const Record& record, const std::string& name) {
  const auto found = record.series.find(name);
  return found == record.series.end() ? nullptr : &found->second;
}

// The error in x over iterations, the loss, or a series by its name. A run that has ended keeps its
// last value.
Figure curve_figure(const Comparison& c, std::size_t p, const std::string& name) {
  const bool is_error = name.empty(), is_loss = name == "loss";
  Figure out{.x_label = "iterations",
             .y_label = is_error ? words("figure.error") : name,
             .is_log_x = true,
             .is_log_y = is_error || is_loss};
  out.lines = lines_of(c, p, [&](const Records& records, FigureLine& line) {
    const auto& iterations = std::ranges::max(records, {}, [](const Record* record) {
                               return record->curve.iteration.size();
                             })->curve.iteration;
    for (const std::size_t i : thinned(iterations.size(), kPoints)) {
      std::vector<Real> values;
      for (const Record* record : records)
        if (const auto* one = is_error  ? &record->curve.x_error
                              : is_loss ? &record->curve.loss
                                        : series_of(*record, name);
            one != nullptr && !one->empty())
          values.push_back((*one)[std::min(i, one->size() - 1)]);
      add_point(line, static_cast<Real>(iterations[i]), std::move(values));
    }
  });
  const auto end = [](const FigureLine& line) { return line.y.back(); };
  out.reading = is_error ? ends_reading(c, out.lines)
                         : words("figure.series-ends", read_lines(c, out.lines, kMostRead, end));
  return out;
}

Figure path_figure(const Comparison& c, std::size_t p, const std::string& pair) {
  const std::size_t bar = pair.find('|');
  Figure out{.x_label = pair.substr(0, bar), .y_label = pair.substr(bar + 1)};
  out.lines = lines_of(c, p, [&](const Records& records, FigureLine& line) {
    const auto *x = series_of(*records[0], out.x_label), *y = series_of(*records[0], out.y_label);
    if (x == nullptr || y == nullptr) return;
    for (const std::size_t i : thinned(x->size(), kPoints)) {
      line.x.push_back((*x)[i]);
      line.y.push_back((*y)[i]);
    }
  });
  out.reading = words("figure.path");
  return out;
}

// take(y*, x*, x) for every number of every sample shown.
template <class Take>
void each_error(const Record& record, Take take) {
  if (!record.exhibit || record.exhibit->truth.is_empty()) return;
  const Exhibit& shown = *record.exhibit;
  for (Index b = 0; b < shown.x.columns(); ++b)
    for (Index i = 0; i < shown.x.rows() && i < shown.target.rows(); ++i)
      take(shown.target(i, b), shown.truth(i, b), shown.x(i, b));
}

Figure scatter_figure(const Comparison& c, std::size_t p) {
  Figure out{.x_label = "x*", .y_label = "x inferred", .has_diagonal = true};
  out.lines = lines_of(c, p, [](const Records& records, FigureLine& line) {
    std::map<Real, Real> sorted;
    each_error(*records[0], [&](Real, Real truth, Real x) { sorted[truth] = x; });
    for (const auto& [truth, x] : sorted) {
      line.x.push_back(truth);
      line.y.push_back(x);
    }
  });
  const auto gap = [](const FigureLine& line) {
    std::vector<Real> gaps;
    for (std::size_t i = 0; i < line.x.size(); ++i) gaps.push_back(std::abs(line.y[i] - line.x[i]));
    return median_of(std::move(gaps));
  };
  out.reading = words("figure.scatter", read_lines(c, out.lines, out.lines.size(), gap));
  return out;
}

Figure decades_figure(const Comparison& c, std::size_t p) {
  Figure out{.x_label = "y*", .y_label = "|x − x*|, median", .is_log_x = true, .is_log_y = true};
  out.lines = lines_of(c, p, [](const Records& records, FigureLine& line) {
    std::map<int, std::vector<Real>> decades;
    for (const Record* record : records)
      each_error(*record, [&](Real target, Real truth, Real x) {
        if (target > 0)
          decades[static_cast<int>(std::floor(std::log10(target)))].push_back(std::abs(x - truth));
      });
    constexpr std::size_t kFewest = 5;  // samples that a median says something of
    for (auto& [decade, gaps] : decades)
      if (gaps.size() >= kFewest) add_point(line, std::pow(10.0, decade + 0.5), std::move(gaps));
  });
  if (!out.lines.empty()) out.reading = words("figure.decades", ends_reading(c, out.lines));
  return out;
}

// The data of a sample, each method's x and the y that follows from it, and the truth.
Figure picture_figure(const Comparison& c, std::size_t p) {
  Figure out;
  FieldFrames last;
  using enum Picture::Kind;
  const auto add = [&](Picture::Kind kind, std::string title, std::span<const float> field) {
    out.pictures.push_back({kind, std::move(title), last.shape[1], {field.begin(), field.end()}});
  };
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    for (const std::size_t run : c.cell(p, s).runs) {
      std::optional<FieldFrames> shown = c.study->fields_of(*c.runs[run].record);
      if (!shown || !shown->has_truth() || shown->shape[1] != shown->shape[2]) continue;
      last = std::move(*shown);
      if (out.pictures.empty()) {
        if (last.has_context()) add(context, c.problems[p].sheet->field->context, last.context());
        add(y, "y*", last.target());
      }
      const std::string method = shown_spec(c.optimizers[s].label);
      add(x, "x, " + method, last.x(last.iterations.size() - 1));
      if (last.has_y()) add(y, "y, " + method, last.y());
      break;
    }
  if (out.pictures.empty()) return out;
  add(x, "x*", last.truth());
  out.reading = words("figure.pictures");
  return out;
}

using Sweep = std::vector<std::pair<Real, std::size_t>>;  // value of the option, problem

Figure sweep_figure(const Comparison& c, const Sweep& sweep, const Panel& panel) {
  const bool is_relative = !panel.divided_by.empty();
  Figure out{
      .x_label = panel.over,
      .y_label = words(is_relative ? "figure.relative" : "figure.absolute", panel.divided_by),
      .is_log_y = true,
      .is_relative = is_relative};
  for (const auto& [value, problem] : sweep)
    out.places.emplace_back(problem_name(c.problems[problem]), value);
  for (std::size_t s = 0; s < c.optimizers.size(); ++s) {
    FigureLine line{.optimizer = s};
    for (const auto& [value, problem] : sweep) {
      std::vector<Real> errors;
      for (const Record* record : records_of(c, problem, s)) {
        const OptionValues& options = record->request.problem.options;
        errors.push_back(record->summary.x_error /
                         (out.is_relative ? options.number(panel.divided_by, std::nan("")) : 1));
      }
      add_point(line, value, std::move(errors));
    }
    if (!line.x.empty()) out.lines.push_back(std::move(line));
  }
  out.reading = words("figure.sweep", panel.over, sweep[0].first, sweep.back().first,
                      ends_reading(c, out.lines));
  return out;
}

const Component& component_of(const Comparison& c, std::size_t problem) {
  static const Component none;
  const auto run =
      std::ranges::find_if(c.cells[problem], [](const Cell& cell) { return !cell.runs.empty(); });
  return run == c.cells[problem].end() ? none : c.runs[run->runs[0]].record->request.problem;
}

// The problems of one name whose options a panel wants.
std::vector<std::size_t> wanted_problems(const Comparison& c, const std::string& name,
                                         const Panel& panel) {
  std::vector<std::size_t> problems;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const Component& problem = component_of(c, p);
    const auto has = [&](const auto& wanted) {
      return problem.options.number(wanted.first, std::nan("")) == wanted.second;
    };
    if (c.problems[p].name == name && problem.is_learned && std::ranges::all_of(panel.where, has))
      problems.push_back(p);
  }
  return problems;
}

// Problems that differ in the swept option alone, together, in its order.
std::vector<Sweep> sweeps_over(const Comparison& c, const std::vector<std::size_t>& problems,
                               const std::string& option) {
  std::map<std::string, Sweep> groups;
  for (const std::size_t p : problems) {
    OptionValues rest = component_of(c, p).options;
    const Real value = rest.number(option, std::nan(""));
    if (std::isnan(value)) continue;
    rest.erase(option);
    std::string key;
    for (const NamedOption& each : rest) key += each.name + "=" + option_text(each.value) + ",";
    groups[key].push_back({value, p});
  }
  std::vector<Sweep> sweeps;
  constexpr std::size_t kFewest = 3;  // two values are no sweep
  for (auto& [key, sweep] : groups) {
    std::ranges::sort(sweep);
    if (sweep.size() >= kFewest) sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

}  // namespace

std::vector<Figure> figures(const Comparison& c) {
  std::vector<Figure> all;
  std::set<std::string> known;
  const auto add = [&](Figure figure, const std::string& problem, const Panel& panel) {
    if (figure.lines.empty() && figure.pictures.empty()) return;
    const bool is_there = std::ranges::any_of(all, [&](const Figure& other) {
      return panel.kind == "curve" && other.kind == "curve" && other.problem == problem;
    });
    if (is_there) return;  // a panel for each problem, besides those of one
    std::tie(figure.problem, figure.title, figure.kind) =
        std::tie(problem, panel.title, panel.kind);
    all.push_back(std::move(figure));
  };
  for (const ProblemAxis& problem : c.problems) {
    if (problem.sheet == nullptr || !known.insert(problem.name).second) continue;
    for (const Panel& panel : problem.sheet->panels) {
      const std::vector<std::size_t> wanted = wanted_problems(c, problem.name, panel);
      if (panel.kind == "sweep")
        for (const Sweep& sweep : sweeps_over(c, wanted, panel.over))
          add(sweep_figure(c, sweep, panel), problem.name, panel);
      else
        for (const std::size_t p : wanted)
          add(panel.kind == "scatter"    ? scatter_figure(c, p)
              : panel.kind == "decades"  ? decades_figure(c, p)
              : panel.kind == "path"     ? path_figure(c, p, panel.quantity)
              : panel.kind == "pictures" ? picture_figure(c, p)
                                         : curve_figure(c, p, panel.quantity),
              problem_name(c.problems[p]), panel);
    }
  }
  return all;
}

// The published values, as marks in the papers' figures.

namespace {

// The lines of a method.
std::vector<std::size_t> optimizers_of(const Comparison& c, const Figure& figure,
                                       const std::string& method) {
  std::vector<std::size_t> optimizers;
  for (const FigureLine& line : figure.lines)
    if (c.optimizers[line.optimizer].method == method) optimizers.push_back(line.optimizer);
  return optimizers;
}

// Where a term of a claim stands across a figure; nothing where it is of another problem.
std::optional<Real> place_in(const Figure& figure, const EvidenceTerm& term) {
  const std::string problem = shown_spec(term.problem);
  const bool is_relative = std::abs(term.scale - 1) > 1e-9;
  if (figure.kind == "sweep" && is_relative == figure.is_relative)
    for (const auto& [name, x] : figure.places)
      if (name == problem) return x;
  if (figure.kind != "curve" || figure.problem != problem || is_relative) return std::nullopt;
  return term.read_at;
}

}  // namespace

void add_published(std::vector<Figure>& all, const Comparison& c,
                   const std::vector<Judgement>& claims) {
  for (Figure& figure : all)
    for (const Judgement& claim : claims)
      for (const EvidenceTerm& term : claim.evidence.terms) {
        const Evidence& evidence = claim.evidence;
        const auto x = place_in(figure, term);
        if (!x && shown_spec(term.problem) != figure.problem) continue;
        const std::vector<std::size_t> optimizers = optimizers_of(c, figure, term.method);
        figure.of_the_paper.insert(optimizers.begin(), optimizers.end());
        const bool is_level = evidence.kind == "value" && evidence.terms.size() == 1 &&
                              claim.band && evidence.column.find("x_error") != std::string::npos;
        if (!x || !is_level || optimizers.empty()) continue;
        figure.published.push_back(
            {.optimizer = optimizers[0],
             .name = fmt::format("{}, published: {}", term.method, column_words(evidence.column)),
             .x = *x,
             .y = evidence.published,
             .low = claim.band->low,
             .high = claim.band->high});
      }
}

}  // namespace isoline::reports
