// A study as Bencher Metric Format (bencher.dev, reference/bencher-metric-format).
#include "reports/exports/exports.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/json.h"
#include "core/oracle.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

void add_measure(Json& measures, const std::string& name, const Spread& spread, Real unit = 1) {
  if (spread.n == 0 || !std::isfinite(spread.median)) return;
  Json& measure = measures[name];
  measure["value"] = spread.median * unit;
  if (std::isfinite(spread.low)) measure["lower_value"] = spread.low * unit;
  if (std::isfinite(spread.high)) measure["upper_value"] = spread.high * unit;
}

Json measures_of(const Comparison& c, const Cell& cell) {
  constexpr Real kNanoseconds = 1e9;  // the unit of Bencher's own measure "latency"
  Json measures = Json::object();
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    const std::string_view tau = c.yardstick.tolerances[t].name;
    const Spread& work = cell.taken[Measure::work][t];
    add_measure(measures, fmt::format("work-to-{}", tau), work);
    add_measure(measures, fmt::format("iterations-to-{}", tau), cell.taken[Measure::iterations][t]);
    measures[fmt::format("reached-{}", tau)]["value"] =
        work.n == 0 ? 0.0 : static_cast<Real>(work.n - work.unsolved) / static_cast<Real>(work.n);
  }
  add_measure(measures, "loss", cell.loss);
  add_measure(measures, "x-error", cell.x_error);
  std::vector<Real> seconds;
  for (const std::size_t run : cell.runs)
    seconds.push_back(c.runs[run].record->summary.wall_seconds);
  add_measure(measures, "latency", spread_of(std::move(seconds)), kNanoseconds);
  return measures;
}

}  // namespace

std::string bencher_json(const Comparison& c) {
  Json benchmarks = Json::object();
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (const Cell& cell = c.cell(p, s); cell.is_measured())
        benchmarks[fmt::format("{} × {}", c.problems[p].spec, c.optimizers[s].label)] =
            measures_of(c, cell);
  return json_text(benchmarks, 1) + "\n";
}

// A study as data folders of COCO (Hansen et al. 2021, Optim. Methods Softw. 36:114–144), in the
// format that its single-objective suite writes: an index, .info, and two tables a function and
// dimension, .dat by targets and .tdat by evaluations, a block a run in both.

namespace {

struct Point {
  std::int64_t evaluations = 1;
  Real loss = 0, best = 0;  // over f_L
};
using Points = std::vector<Point>;

constexpr std::int64_t kStart = 1;  // the start's own evaluation, which the harness pays for

// Where losses were seen: finite ones alone, the last of those at one evaluation.
Points curve_of(const Run& run) {
  const Curve& curve = run.record->curve;
  Points points;
  Real best = kNever;
  for (std::size_t i = 0; i < curve.loss.size(); ++i) {
    const Real loss = curve.loss[i] - run.minimum;
    if (!std::isfinite(loss)) continue;
    best = std::min(best, loss);
    const Point point{curve.work[i] + kStart, loss, best};
    if (!points.empty() && points.back().evaluations == point.evaluations)
      points.back() = point;
    else
      points.push_back(point);
  }
  return points;
}

// The first points at targets: exact if the record has hits, which are finer than the
// curve. A hit gives the target only, τ s: the loss was at most that.
Points targets_of(const Run& run, const Points& curve) {
  std::map<std::int64_t, Real> met;  // by evaluations
  const auto meet = [&](std::int64_t evaluations, Real loss) {
    const auto [at, is_new] = met.emplace(evaluations, loss);
    if (!is_new) at->second = std::min(at->second, loss);
  };
  for (const Point& point : curve) meet(point.evaluations, point.best);
  if (run.record->hits && run.scale > 0) {
    const Hits& hits = *run.record->hits;
    for (std::size_t j = 0; j < hits.work.size(); ++j)
      if (hits.iteration[j] >= 0) meet(hits.work[j] + kStart, hits.target[j] * run.scale);
  }
  Points points;
  for (const auto& [evaluations, loss] : met)
    if (points.empty() || loss < points.back().best) points.push_back({evaluations, loss, loss});
  return points;
}

std::string block_of(const Points& points, Real minimum) {
  std::string text = fmt::format(
      "% function evaluation | noise-free fitness - Fopt ({:.16e}) | best noise-free fitness - "
      "Fopt | "
      "measured fitness | best measured fitness\n",
      minimum);
  for (const Point& point : points)
    text += fmt::format("{} {:+.16e} {:+.16e} {:+.16e} {:+.16e}\n", point.evaluations, point.loss,
                        point.best, point.loss + minimum, point.best + minimum);
  return text;
}

// Letters, digits and dashes: a name that any file system has, and any shell reads.
std::string plain_name(std::string_view label) {
  std::string name;
  for (const char letter : label) {
    const bool is_plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                          (letter >= '0' && letter <= '9');
    if (is_plain)
      name += letter;
    else if (!name.empty() && name.back() != '-')
      name += '-';
  }
  constexpr std::size_t kMost = 80;
  name.resize(std::min(name.size(), kMost));
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name.empty() ? "method" : name;
}

// Each method's folder, none twice.
std::vector<std::string> folders_of(const Comparison& c) {
  std::vector<std::string> folders;
  std::set<std::string> taken;
  for (const OptimizerAxis& optimizer : c.optimizers) {
    const std::string name = plain_name(optimizer.label);
    std::string folder = name;
    for (int number = 2; !taken.insert(folder).second; ++number)
      folder = fmt::format("{}-{}", name, number);
    folders.push_back(folder);
  }
  return folders;
}

std::string quoted_name(std::string label) {
  std::ranges::replace(label, '\'', '"');
  return label;
}

// One method on one problem: its line of the index, and its two tables.
class Writer {
 public:
  Writer(const Comparison& c, std::size_t problem, std::size_t optimizer, const std::string& folder)
      : c_(c), problem_(problem), optimizer_(optimizer), folder_(folder) {}

  void write(CocoExport& out) {
    for (const std::size_t index : c_.cell(problem_, optimizer_).runs) add(c_.runs[index], out);
    if (instances_.empty()) return;
    const std::string function = fmt::format("f{}", problem_ + 1);
    const std::string table = fmt::format("data_{0}/isoline_{0}_DIM{1}", function, dimension());
    std::string index = fmt::format(
        "funcId = {}, DIM = {}, Precision = 1.000e-08, algId = '{}'\n"
        "% {}; evaluations are forward solves, and the start is the first; instances are seeds + "
        "1\n"
        "{}.dat",
        problem_ + 1, dimension(), quoted_name(c_.optimizers[optimizer_].label),
        c_.problems[problem_].spec, table);
    out.files.push_back(
        {fmt::format("{}/isoline_{}.info", folder_, function), index + instances_ + "\n"});
    out.files.push_back({fmt::format("{}/{}.dat", folder_, table), by_target_});
    out.files.push_back({fmt::format("{}/{}.tdat", folder_, table), by_evaluation_});
  }

 private:
  Index dimension() const { return c_.problems[problem_].sheet->unknowns; }

  void add(const Run& run, CocoExport& out) {
    const Points curve = curve_of(run);
    if (curve.empty()) {
      out.left_out.push_back(
          fmt::format("{} × {}, seed {}: no finite loss above f_L", c_.problems[problem_].spec,
                      c_.optimizers[optimizer_].label, run.record->request.seed));
      return;
    }
    const Points targets = targets_of(run, curve);
    by_target_ += block_of(targets, run.minimum);
    by_evaluation_ += block_of(curve, run.minimum);
    const Point& last = targets.back();
    instances_ += fmt::format(", {}:{}|{:.1e}", run.record->request.seed + 1,
                              std::max(last.evaluations, curve.back().evaluations), last.best);
  }

  const Comparison& c_;
  std::size_t problem_, optimizer_;
  const std::string& folder_;
  std::string by_target_, by_evaluation_, instances_;
};

}  // namespace

CocoExport coco_export(const Comparison& c) {
  CocoExport out;
  std::string functions = "funcId,DIM,problem\r\n";
  const std::vector<std::string> folders = folders_of(c);
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const ProblemAxis& problem = c.problems[p];
    const Index unknowns = problem.sheet == nullptr ? 0 : problem.sheet->unknowns;
    if (unknowns <= 0 || problem.sheet->spec != problem.spec) {
      out.left_out.push_back(
          fmt::format("{}: no file of metadata gives its number of unknowns", problem.spec));
      continue;
    }
    const bool has_comma = problem.spec.find(',') != std::string::npos;
    functions += fmt::format("{},{},{}\r\n", p + 1, unknowns,
                             has_comma ? "\"" + problem.spec + "\"" : problem.spec);
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured()) Writer(c, p, s, folders[s]).write(out);
  }
  out.files.push_back({"functions.csv", functions});
  return out;
}

// The curves of a study as tidy CSV.

namespace {

// RFC 4180: quoted where a comma, a quote or a line end stands in it, quotes doubled. To the byte,
// unlike the report's own table, which a spreadsheet opens: this one is for programs.
std::string field_of(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + '"';
}

std::string optional_figure(const std::optional<Real>& value) {
  return value ? exact_figure(*value) : "";
}

// "true", "false", or nothing where it is not known.
std::string verified_text(const Record& record, const std::string& tau) {
  const auto at = record.verified.find(tau);
  if (at == record.verified.end() || !at->second) return "";
  return *at->second ? "true" : "false";
}

std::string head() {
  std::string names =
      "problem,optimizer,seed,status,cell,build,imported,verified_1e-1,verified_1e-3,verified_1e-6,"
      "minimum,scale,x_scale,iteration,work";
  for (const std::string_view oracle : kOracleNames) names += fmt::format(",{}", oracle);
  return names + ",wall_seconds,processor_seconds,loss,x_error,gradient_norm,step_norm\r\n";
}

// The beginning of all rows of a run.
std::string who_of(const Record& record) {
  const Request& request = record.request;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", field_of(request.problem.spec),
                     field_of(request.optimizer.spec), request.seed, name_of(record.status),
                     record.cell, record.build, record.imported ? "true" : "false",
                     verified_text(record, "1e-1"), verified_text(record, "1e-3"),
                     verified_text(record, "1e-6"), optional_figure(record.minimum),
                     optional_figure(record.scale), optional_figure(record.x_scale));
}

void add_rows(std::string& csv, const Record& record) {
  const Curve& curve = record.curve;
  const std::string who = who_of(record);
  for (std::size_t i = 0; i < curve.iteration.size(); ++i) {
    csv += fmt::format("{},{},{}", who, curve.iteration[i], curve.work[i]);
    for (const std::string_view oracle : kOracleNames) {
      const auto counts = curve.counts.find(std::string(oracle));
      csv += fmt::format(",{}", counts == curve.counts.end() ? 0 : counts->second[i]);
    }
    for (const auto* column : {&curve.wall_seconds, &curve.processor_seconds, &curve.loss,
                               &curve.x_error, &curve.gradient_norm, &curve.step_norm})
      csv += "," + exact_figure((*column)[i]);
    csv += "\r\n";
  }
  constexpr std::size_t kFigures = 8;  // of each point, its counts by oracle aside
  if (curve.iteration.empty()) csv += who + std::string(kFigures + kOracles, ',') + "\r\n";
}

}  // namespace

std::string curves_csv(const Comparison& comparison) {
  std::string csv = head();
  for (const Run& run : comparison.runs)
    if (!run.is_repeated) add_rows(csv, *run.record);
  return csv;
}

}  // namespace isoline::reports
