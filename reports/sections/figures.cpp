// Panels to figures: which runs belong to each, and what of them is drawn.
#include "reports/sections/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "reports/sections/panels.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

const Component& component_of(const Comparison& c, std::size_t problem) {
  static const Component none;
  for (const Cell& cell : c.cells[problem])
    if (!cell.runs.empty()) return c.runs[cell.runs[0]].record->request.problem;
  return none;
}

bool is_wanted(const Component& problem, const Panel& panel) {
  return problem.is_learned && std::ranges::all_of(panel.where, [&](const auto& wanted) {
           return problem.options.number(wanted.first, std::nan("")) == wanted.second;
         });
}

// The problems of one name whose options a panel wants.
std::vector<std::size_t> wanted_problems(const Comparison& c, const std::string& name,
                                         const Panel& panel) {
  std::vector<std::size_t> problems;
  for (std::size_t p = 0; p < c.problems.size(); ++p)
    if (c.problems[p].name == name && is_wanted(component_of(c, p), panel)) problems.push_back(p);
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
    for (const NamedOption& each : rest) key += each.name + "=" + text_of(each.value) + ",";
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

void add(std::vector<Figure>& all, Figure figure, const std::string& problem, const Panel& panel) {
  if (figure.lines.empty() && figure.pictures.empty()) return;
  figure.problem = problem;
  figure.title = panel.title;
  figure.kind = panel.kind;
  all.push_back(std::move(figure));
}

void add_panel(const Comparison& c, const std::string& name, const Panel& panel,
               std::vector<Figure>& all) {
  const std::vector<std::size_t> problems = wanted_problems(c, name, panel);
  if (panel.kind == "sweep") {
    for (const Sweep& sweep : sweeps_over(c, problems, panel.over))
      add(all, sweep_figure(c, sweep, panel), name, panel);
    return;
  }
  for (const std::size_t p : problems)
    add(all, problem_figure(c, p, panel), problem_name(c.problems[p]), panel);
}

}  // namespace

std::vector<Figure> figures(const Comparison& c) {
  std::vector<Figure> all;
  std::set<std::string> known;
  for (const ProblemAxis& problem : c.problems)
    if (problem.sheet != nullptr && known.insert(problem.name).second)
      for (const Panel& panel : problem.sheet->panels) add_panel(c, problem.name, panel, all);
  return all;
}

}  // namespace isoline::reports
