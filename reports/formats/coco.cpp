// Data folders of COCO (Hansen et al. 2021, Optim. Methods Softw. 36:114–144), in the
// format that its single-objective suite writes: an index, .info, and two tables a function and
// dimension, .dat by targets and .tdat by evaluations, a block a run in both.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "core/seeds.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {

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
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0)  // of the locale "C"
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

// One method on one problem: its line of the index, and its two tables.
void add_files(Export& out, const Comparison& c, std::size_t p, std::size_t s,
               const std::string& folder) {
  std::string by_target, by_evaluation, instances;
  for (const std::size_t index : c.cell(p, s).runs) {
    const Run& run = c.runs[index];
    const std::uint64_t seed = run.record->request.seed;
    const Points curve = curve_of(run);
    if (curve.empty()) {
      out.left_out.push_back(fmt::format("{} × {}, seed {}: no finite loss above f_L",
                                         c.problems[p].spec, c.optimizers[s].label,
                                         seed_text(seed)));
      continue;
    }
    const Points targets = targets_of(run, curve);
    by_target += block_of(targets, run.minimum);
    by_evaluation += block_of(curve, run.minimum);
    const Point& last = targets.back();
    instances += fmt::format(", {}:{}|{:.1e}", instance_of(seed) + 1,
                             std::max(last.evaluations, curve.back().evaluations), last.best);
  }
  if (instances.empty()) return;
  const Index dimension = c.problems[p].sheet->unknowns;
  const std::string table = fmt::format("data_f{0}/isoline_f{0}_DIM{1}", p + 1, dimension);
  std::string label = c.optimizers[s].label;
  std::ranges::replace(label, '\'', '"');
  const std::string index = fmt::format(
      "funcId = {}, DIM = {}, Precision = 1.000e-08, algId = '{}'\n"
      "% {}; evaluations are forward solves, and the start is the first; instances are "
      "counted from 1\n"
      "{}.dat{}\n",
      p + 1, dimension, label, c.problems[p].spec, table, instances);
  out.files[fmt::format("{}/isoline_f{}.info", folder, p + 1)] = index;
  out.files[fmt::format("{}/{}.dat", folder, table)] = by_target;
  out.files[fmt::format("{}/{}.tdat", folder, table)] = by_evaluation;
}

}  // namespace

Export coco_export(const Comparison& c) {
  Export out;
  std::string functions = "funcId,DIM,problem\r\n";
  const std::vector<std::string> folders = folders_of(c);
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const ProblemAxis& problem = c.problems[p];
    if (!problem.has_own_sheet() || problem.sheet->unknowns <= 0) {
      out.left_out.push_back(
          fmt::format("{}: no file of metadata gives its number of unknowns", problem.spec));
      continue;
    }
    functions +=
        fmt::format("{},{},{}\r\n", p + 1, problem.sheet->unknowns, exact_csv_field(problem.spec));
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).is_measured()) add_files(out, c, p, s, folders[s]);
  }
  out.files["functions.csv"] = functions;
  return out;
}

}  // namespace isoline::reports
