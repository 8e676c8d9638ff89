// Finds the problems and optimizers of a study, and what to call them.
#include "reports/axes.h"

#include <algorithm>
#include <utility>

namespace isoline::reports {
namespace {

std::string name_in(const std::string& spec) { return spec.substr(0, spec.find('[')); }

// The sheet of this very spec, else any of the same name.
const Sheet* sheet_of(const Study& study, const std::string& kind, const std::string& spec) {
  const Sheet* found = nullptr;
  for (const Sheet& sheet : study.sheets) {
    if (sheet.kind != kind) continue;
    if (sheet.spec == spec) return &sheet;
    if (sheet.name == name_in(spec) && found == nullptr) found = &sheet;
  }
  return found;
}

}  // namespace

OptimizerLabels::OptimizerLabels(const Study& study) {
  std::set<std::pair<std::string, std::string>> seen;                // problem, optimizer spec
  std::map<std::pair<std::string, std::string>, std::size_t> specs;  // by problem and name
  for (const Record& record : study.runs) {
    const Component& optimizer = record.request.optimizer;
    const std::string& problem = record.request.problem.spec;
    if (record.request.rates.ends_with("-tuned.json")) {
      tuned_.emplace(problem, optimizer.spec);
      continue;
    }
    if (!record.request.rates.empty()) by_name_.insert(optimizer.name);
    if (seen.emplace(problem, optimizer.spec).second) ++specs[{problem, optimizer.name}];
  }
  for (const auto& [where, count] : specs)
    if (count > 1) by_name_.erase(where.second);
}

std::string OptimizerLabels::operator()(const std::string& problem, const std::string& spec) const {
  std::string name = name_in(spec);
  if (tuned_.contains({problem, spec})) return name + ", tuned";
  return by_name_.contains(name) ? name : spec;
}

std::vector<ProblemAxis> problem_axis(const Study& study) {
  std::set<std::string> specs;
  for (const Record& record : study.runs) specs.insert(record.request.problem.spec);
  for (const PlannedCell& cell : study.plan.cells) specs.insert(cell.problem);
  std::vector<ProblemAxis> axis;
  for (const std::string& spec : specs)
    axis.push_back({.spec = spec, .sheet = sheet_of(study, "problem", spec)});
  for (ProblemAxis& problem : axis)
    if (problem.sheet != nullptr && problem.sheet->spec == problem.spec)
      problem.prices = Prices(problem.sheet);
  for (const Record& record : study.runs) {
    const auto at = std::ranges::find(axis, record.request.problem.spec, &ProblemAxis::spec);
    const bool could_declare = record.status != Status::inapplicable;
    if (could_declare && !record.minimum) at->is_minimum_declared = false;
  }
  return axis;
}

std::vector<OptimizerAxis> optimizer_axis(const Study& study, const OptimizerLabels& label) {
  std::map<std::string, std::string> specs;  // by label, any of them
  for (const Record& record : study.runs)
    specs.emplace(label(record.request.problem.spec, record.request.optimizer.spec),
                  record.request.optimizer.spec);
  for (const PlannedCell& cell : study.plan.cells)
    specs.emplace(label(cell.problem, cell.optimizer), cell.optimizer);
  std::vector<OptimizerAxis> axis;
  for (const auto& [name, spec] : specs)
    axis.push_back({.label = name, .sheet = sheet_of(study, "optimizer", spec), .privileges = {}});
  return axis;
}

}  // namespace isoline::reports
