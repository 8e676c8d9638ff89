// Finds the problems and optimizers of a study, and what to call them.
#include "core/results/labels.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/errors.h"
#include "core/privilege.h"
#include "core/spec.h"

namespace isoline::results {
namespace {

constexpr std::size_t kLong = 24;  // letters: a shorter label is shown as it is

// "sip[inverse=newton], tuned" is a spec and what follows it.
struct Label {
  Spec spec;
  std::string rest;
};

// A text that is not a spec, from imported records, has no options to omit.
Label label_of(const std::string& text) {
  const std::size_t close = text.rfind(']');
  const std::size_t end = close == std::string::npos ? text.find(',') : close + 1;
  const std::string spec = text.substr(0, end);
  try {
    return {parse_spec(spec), text.substr(spec.size())};
  } catch (const UsageError&) {
    return {{.name = text, .options = {}}, ""};
  }
}

using Option = std::pair<std::string, std::string>;

std::set<Option> common_to(const std::vector<Label>& labels) {
  const auto& first = labels.front().spec.options;
  std::set<Option> common(first.begin(), first.end());
  for (const Label& label : labels)
    std::erase_if(common, [&](const Option& option) {
      return std::ranges::find(label.spec.options, option) == label.spec.options.end();
    });
  return common;
}

std::string label_text(const Label& label, const std::set<Option>& left_out) {
  std::string options;
  for (const Option& option : label.spec.options)
    if (!left_out.contains(option))
      options += (options.empty() ? "" : ",") + option.first + "=" + option.second;
  return label.spec.name + (options.empty() ? "" : "[" + options + "]") + label.rest;
}

}  // namespace

std::vector<std::string> brief_labels(const std::vector<std::string>& labels) {
  std::map<std::string, std::vector<Label>> methods;
  for (const std::string& label : labels) {
    const Label parsed = label_of(label);
    methods[parsed.spec.name].push_back(parsed);
  }
  std::vector<std::string> brief;
  std::map<std::string, int> count;
  for (const std::string& label : labels) {
    const Label parsed = label_of(label);
    brief.push_back(
        label.size() <= kLong ? label : label_text(parsed, common_to(methods[parsed.spec.name])));
    ++count[brief.back()];
  }
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (count[brief[i]] > 1) brief[i] = labels[i];
  return brief;
}

namespace {

// The sheet of this very spec, else any of the same name.
const Sheet* sheet_of(const Study& study, const std::string& kind, const std::string& spec,
                      const std::string& name) {
  const Sheet* found = nullptr;
  for (const Sheet& sheet : study.sheets) {
    if (sheet.kind != kind) continue;
    if (sheet.spec == spec) return &sheet;
    if (sheet.name == name && found == nullptr) found = &sheet;
  }
  return found;
}

// Components by spec; of what was planned and has not run the spec alone is known.
std::map<std::string, std::string> names_by_spec(const Study& study, Component Request::*asked,
                                                 std::string PlannedCell::*planned) {
  std::map<std::string, std::string> names;
  for (const Record& record : study.runs) {
    const Component& component = record.request.*asked;
    names.emplace(component.spec, component.name);
  }
  for (const PlannedCell& cell : study.plan.cells)
    if (const std::string& spec = cell.*planned; !names.contains(spec))
      names.emplace(spec, name_of_spec(spec));
  return names;
}

// "P⁻¹" where the physics are inverted for it; else in the words of its records.
std::string given_by(const std::set<std::string>& privileges) {
  std::string text;
  for (const std::string& privilege : privileges) {
    const std::string given = is_inverse_of_physics(privilege) ? "P⁻¹" : privilege;
    if (text.find(given) == std::string::npos) text += (text.empty() ? "" : " and ") + given;
  }
  return text;
}

}  // namespace

OptimizerLabels::OptimizerLabels(const Study& study)
    : names_(names_by_spec(study, &Request::optimizer, &PlannedCell::optimizer)) {
  find_foreign(study);
  std::set<Pair> seen;                // problem, optimizer spec
  std::map<Pair, std::size_t> specs;  // by problem and name
  for (const Record& record : study.runs) {
    const Component& optimizer = record.request.optimizer;
    const std::string& problem = record.request.problem.spec;
    const RatesKind rates = kind_of_rates(record.request.rates);
    if (rates == RatesKind::tuned) {
      tuned_.emplace(problem, optimizer.spec);
      continue;
    }
    if (rates == RatesKind::published) by_name_.insert(optimizer.name);
    if (seen.emplace(problem, optimizer.spec).second) ++specs[{problem, optimizer.name}];
  }
  for (const auto& [where, count] : specs)
    if (count > 1) by_name_.erase(where.second);
  find_both_ways(study);
  find_meanings(study);
}

void OptimizerLabels::find_foreign(const Study& study) {
  std::set<std::string> taken;
  for (const auto& [spec, name] : names_) taken.insert({spec, name});
  for (const Record& record : study.runs) {
    if (!record.foreign.optimizer) continue;
    const std::string& spec = record.request.optimizer.spec;
    if (foreign_.contains(spec)) continue;
    const std::string& name = record.foreign.optimizer->label;
    const bool is_free = !name.empty() && taken.insert(name).second;
    foreign_[spec] = is_free ? name : spec;
  }
}

// Where one problem has a method both ways, with different options: at its defaults, and at the one
// setting that a table gives it. Several settings of one problem were asked for one by one.
void OptimizerLabels::find_both_ways(const Study& study) {
  std::set<Pair> plain;  // problem and name, at the defaults
  std::map<Pair, std::set<std::string>> settings;
  std::set<std::string> swept;  // names
  for (const Record& record : study.runs) {
    const Component& optimizer = record.request.optimizer;
    const Pair pair(record.request.problem.spec, optimizer.name);
    if (optimizer.spec == optimizer.name)
      plain.insert(pair);
    else if (kind_of_rates(record.request.rates) == RatesKind::published)
      rated_.insert(pair);
    if (rated_.contains(pair) && optimizer.spec != optimizer.name) {
      settings[pair].insert(optimizer.spec);
      if (settings[pair].size() > 1) swept.insert(optimizer.name);
    }
  }
  for (const auto& pair : rated_)
    if (plain.contains(pair) && !swept.contains(pair.second)) both_ways_.insert(pair.second);
}

// From completed runs: an inapplicable pair used nothing and shows nothing about a method.
void OptimizerLabels::find_meanings(const Study& study) {
  std::map<std::string, std::map<std::string, std::set<std::string>>> seen;  // label, problem
  for (const Record& record : study.runs) {
    if (record.status == Status::inapplicable) continue;
    const std::string& problem = record.request.problem.spec;
    for (const std::string& whole : wholes(problem, record.request.optimizer.spec))
      seen[whole][problem].insert(record.privileges.begin(), record.privileges.end());
  }
  for (const auto& [label, problems] : seen) {
    const auto sees = [](const auto& of_problem) { return !of_problem.second.empty(); };
    if (std::ranges::all_of(problems, sees) || std::ranges::none_of(problems, sees)) continue;
    for (const auto& [problem, privileges] : problems)
      meanings_[label][problem] = given_by(privileges);
  }
}

std::string OptimizerLabels::meaning(const std::string& problem, const std::string& whole) const {
  const auto meanings = meanings_.find(whole);
  if (meanings == meanings_.end()) return whole;
  const auto given = meanings->second.find(problem);
  if (given == meanings->second.end() || given->second.empty()) return whole;
  return whole + ", given " + given->second;
}

std::vector<std::string> OptimizerLabels::of(const std::string& problem,
                                             const std::string& spec) const {
  std::vector<std::string> labels;
  for (const std::string& whole : wholes(problem, spec)) labels.push_back(meaning(problem, whole));
  return labels;
}

std::vector<std::string> OptimizerLabels::wholes(const std::string& problem,
                                                 const std::string& spec) const {
  if (const auto foreign = foreign_.find(spec); foreign != foreign_.end()) return {foreign->second};
  const std::string& name = names_.at(spec);
  const std::string tuned = name + ", tuned";
  if (tuned_.contains({problem, spec})) return {tuned};
  if (both_ways_.contains(name)) {
    if (spec != name) return {rated_.contains({problem, name}) ? tuned : spec};
    if (!rated_.contains({problem, name})) return {name, tuned};
    return {name};
  }
  return {by_name_.contains(name) ? name : spec};
}

std::vector<ProblemAxis> problem_axis(const Study& study) {
  const auto names = names_by_spec(study, &Request::problem, &PlannedCell::problem);
  std::vector<ProblemAxis> axis;
  for (const auto& [spec, name] : names)
    axis.push_back({.spec = spec, .name = name, .sheet = sheet_of(study, "problem", spec, name)});
  for (ProblemAxis& problem : axis)
    if (problem.has_own_sheet()) problem.prices = Prices(problem.sheet);
  for (const Record& record : study.runs) {
    const auto at = std::ranges::find(axis, record.request.problem.spec, &ProblemAxis::spec);
    const bool could_declare = record.status != Status::inapplicable;
    if (could_declare && !record.minimum) at->is_minimum_declared = false;
    if (record.aim == Aim::x && record.x_scale) at->aim = Aim::x;
    at->is_learned = record.request.problem.is_learned;
    if (!record.foreign.problem) continue;
    at->is_foreign = true;
    at->label = record.foreign.problem->label;
  }
  return axis;
}

std::vector<OptimizerAxis> optimizer_axis(const Study& study, const OptimizerLabels& labels) {
  struct Known {
    std::string spec, whole;
    bool is_imported = false;
  };
  std::map<std::string, Known> known;  // by label, any spec of it
  const auto know = [&](const std::string& problem, const std::string& spec, bool is_imported) {
    for (const std::string& whole : labels.wholes(problem, spec)) {
      const std::string label = labels.meaning(problem, whole);
      known.emplace(label, Known{spec, whole}).first->second.is_imported |= is_imported;
    }
  };
  for (const Record& record : study.runs)
    know(record.request.problem.spec, record.request.optimizer.spec, record.imported.has_value());
  for (const PlannedCell& cell : study.plan.cells) know(cell.problem, cell.optimizer, false);
  std::vector<std::string> names;
  for (const auto& [label, each] : known) names.push_back(label);
  const std::vector<std::string> brief = brief_labels(names);
  std::vector<OptimizerAxis> axis;
  for (const auto& [label, each] : known)
    axis.push_back({.label = label,
                    .brief = brief[axis.size()],
                    .method = labels.method(each.spec),
                    .whole = each.whole,
                    .is_meaning = labels.has_meanings(each.whole),
                    .is_foreign = labels.is_foreign(each.spec),
                    .sheet = sheet_of(study, "optimizer", each.spec, labels.method(each.spec)),
                    .privileges = {},
                    .is_imported = each.is_imported});
  return axis;
}

}  // namespace isoline::results
