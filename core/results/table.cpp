// Finds the problems and optimizers of a study and their labels, reads records into rows, and
// pivots rows into cells of a problem and an optimizer.
#include "core/results/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/errors.h"
#include "core/oracle.h"
#include "core/spec.h"
#include "core/threads.h"

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

// But for the options that each label of `alike` has.
std::string label_text(const Label& label, const std::vector<Label>& alike) {
  std::string options;
  for (const auto& option : label.spec.options) {
    const auto has_it = [&](const Label& other) {
      return std::ranges::find(other.spec.options, option) != other.spec.options.end();
    };
    if (!std::ranges::all_of(alike, has_it))
      options += (options.empty() ? "" : ",") + option.first + "=" + option.second;
  }
  return label.spec.name + (options.empty() ? "" : "[" + options + "]") + label.rest;
}

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

// "P⁻¹" where the physics are inverted for it; else "the exact Hessian", "the ground truth".
std::string given_by(const std::set<std::string>& privileges) {
  std::string text;
  for (const std::string& privilege : privileges) {
    const std::string given = is_inverse_of_physics(privilege) ? "P⁻¹"
                              : privilege == name_of(Privilege::estimate)
                                  ? "an estimate from the data generator"
                                  : "the " + privilege;
    if (text.find(given) == std::string::npos) text += (text.empty() ? "" : " and ") + given;
  }
  return text;
}

// Names of optimizers. A file of rates gives one method different options on each problem. The
// method then keeps one row under its name, unless some problem has two runs of that name. A method
// with tuned rates gets a row of its own, "adam, tuned". A method with extra information on some
// problems only becomes two: "sip, given P⁻¹" and "sip". An external program has the name that it
// gives itself, unless another method has this name. If a study contains a method with its defaults
// and with rates of tables, they are "gd" and "gd, tuned"; if both are equal on a problem, its
// single run is in both rows. Where one cell was run with several budgets, each budget has a row.
class OptimizerLabels {
 public:
  explicit OptimizerLabels(const Study& study);
  std::vector<std::string> of(const std::string& problem, std::vector<std::string> wholes) const;
  const std::string& method(const std::string& spec) const { return names_.at(spec); }
  // For all meanings.
  std::vector<std::string> wholes(const Request& request) const;
  std::vector<std::string> wholes(const std::string& problem, const std::string& spec) const;
  std::string meaning(const std::string& problem, const std::string& whole) const;
  bool has_meanings(const std::string& whole) const { return meanings_.contains(whole); }
  bool is_foreign(const std::string& spec) const { return foreign_.contains(spec); }
  bool has_budgets(const std::string& spec) const { return several_budgets_.contains(spec); }

 private:
  using Pair = std::pair<std::string, std::string>;

  void find_foreign(const Study& study);
  void find_budgets(const Study& study);
  void find_both_ways(const Study& study);
  void find_meanings(const Study& study);

  std::set<Pair> tuned_;                        // problem and optimizer, as specs
  std::set<std::string> by_name_;               // names that stand for all their specs
  std::map<std::string, std::string> names_;    // by spec, as records have them
  std::map<std::string, std::string> foreign_;  // by spec: what other programs call themselves
  std::set<std::string> several_budgets_;       // specs that some problem has with two budgets
  std::set<std::string> both_ways_;             // names at their defaults and with rates
  std::set<Pair> rated_;                        // problem and name, with another rate
  // By label of all meanings and problem: what is given there beyond the problem, or nothing.
  std::map<std::string, std::map<std::string, std::string>> meanings_;
};

OptimizerLabels::OptimizerLabels(const Study& study)
    : names_(names_by_spec(study, &Request::optimizer, &PlannedCell::optimizer)) {
  find_foreign(study);
  find_budgets(study);
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

void OptimizerLabels::find_budgets(const Study& study) {
  std::map<Pair, std::string> first;  // by problem and optimizer
  for (const Record& record : study.runs) {
    if (record.imported) continue;  // it has as many iterations as its curve
    const Request& request = record.request;
    const std::string budget = budget_options(request);
    const auto [known, is_new] =
        first.try_emplace({request.problem.spec, request.optimizer.spec}, budget);
    if (known->second != budget) several_budgets_.insert(request.optimizer.spec);
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
    for (const std::string& whole : wholes(record.request))
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
                                             std::vector<std::string> wholes) const {
  for (std::string& whole : wholes) whole = meaning(problem, whole);
  return wholes;
}

std::vector<std::string> OptimizerLabels::wholes(const Request& request) const {
  std::vector<std::string> labels = wholes(request.problem.spec, request.optimizer.spec);
  if (has_budgets(request.optimizer.spec))
    for (std::string& label : labels) label += ", " + budget_options(request);
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
  std::map<std::string, std::map<std::uint64_t, Real>> goals;  // by problem and seed
  for (const Record& record : study.runs) {
    const auto at = std::ranges::find(axis, record.request.problem.spec, &ProblemAxis::spec);
    const bool could_declare = record.status != Status::inapplicable;
    const bool has_loss = could_declare && std::isfinite(record.summary.best_loss);
    if (has_loss && !record.minimum && !record.imported) {
      at->is_minimum_known = false;
      at->is_least_of_runs = is_of_own_problem(record);
    }
    if (record.aim == Aim::x && record.x_scale) at->aim = Aim::x;
    at->is_learned = record.request.problem.is_learned;
    at->noise = record.request.problem.options.number("noise", 0);
    at->is_bounded |= !record.curve.kkt_residual.empty();
    at->has_failures = record.request.problem.options.number("fail", 0) > 0;
    if (at->aim == Aim::x && record.x_scale && could_declare)
      goals[at->spec].emplace(record.request.seed, x_goal(0, 1, record.x_floor / *record.x_scale));
    if (!record.foreign.problem) continue;
    constexpr std::string_view kUnchecked = " (uncertified)";
    at->label = record.foreign.problem->label;
    at->is_unchecked = at->label.ends_with(kUnchecked);
    at->is_foreign = !at->is_unchecked;
    if (at->is_unchecked) at->label.resize(at->label.size() - kUnchecked.size());
  }
  std::map<std::string, int> of_label;
  for (ProblemAxis& problem : axis) {
    std::vector<Real> all;
    for (const auto& [seed, goal] : goals[problem.spec]) all.push_back(goal);
    if (!all.empty()) problem.least_goal = median_of(std::move(all));
    ++of_label[problem.label];
  }
  for (ProblemAxis& problem : axis)  // two commands of one script
    if (of_label[problem.label] > 1) problem.label.clear();
  return axis;
}

std::vector<OptimizerAxis> optimizer_axis(const Study& study, const OptimizerLabels& labels) {
  struct Known {
    std::string spec, whole;
    bool is_imported = false;
  };
  std::map<std::string, Known> known;  // by label, any spec of it
  const auto know = [&](const std::vector<std::string>& wholes, const std::string& problem,
                        const std::string& spec, bool is_imported) {
    for (const std::string& whole : wholes) {
      const std::string label = labels.meaning(problem, whole);
      known.emplace(label, Known{spec, whole}).first->second.is_imported |= is_imported;
    }
  };
  std::unordered_set<std::string_view> answered;
  for (const Record& record : study.runs) {
    const Request& request = record.request;
    answered.insert(record.cell);
    know(labels.wholes(request), request.problem.spec, request.optimizer.spec,
         record.imported.has_value());
  }
  for (const PlannedCell& cell : study.plan.cells)
    if (!answered.contains(cell.cell))
      know(labels.wholes(cell.problem, cell.optimizer), cell.problem, cell.optimizer, false);
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
                    .has_budgets = labels.has_budgets(each.spec),
                    .sheet = sheet_of(study, "optimizer", each.spec, labels.method(each.spec)),
                    .privileges = {},
                    .is_imported = each.is_imported});
  return axis;
}

// Rows and cells.

// Places of names on an axis.
template <class Axis>
std::unordered_map<std::string, std::size_t> places(const std::vector<Axis>& axis,
                                                    std::string Axis::*name) {
  std::unordered_map<std::string, std::size_t> at;
  for (std::size_t i = 0; i < axis.size(); ++i) at.emplace(axis[i].*name, i);
  return at;
}

// A learned run is judged by its validation curve, whose end has the noise of its last batches; an
// imported one has no returned point.
std::size_t returned_targets(const Run& run, const ProblemAxis& problem) {
  const Record& record = *run.record;
  std::size_t met = run.targets.size();
  if (problem.is_learned || record.imported) return met;
  const auto misses = [&](std::size_t j) {
    if (run.aim == Aim::x)
      return !(record.summary.x_error <=
               x_goal(rung(j), record.x_scale.value_or(0), record.x_floor));
    return !(record.summary.loss <= run.minimum + rung(j) * run.scale);
  };
  while (met > 0 && misses(met - 1)) --met;
  return met;
}

Run run_of(const Record& record, const ProblemAxis& problem, const BestKnown& best) {
  Run run{.record = &record,
          .seed = record.request.seed,
          .aim = problem.aim,
          .targets = {},
          .is_timed_alone = record.provenance.run.is_timed_alone()};
  if (record.status == Status::inapplicable) return run;
  run.minimum = best.minimum(record);
  run.scale = best.scale(record);
  run.spent = problem.prices.cost(record);
  std::vector<Reached> loss = problem.lacks_least_loss()
                                  ? std::vector<Reached>()
                                  : targets_met(record, problem.prices, Aim::loss, best),
                       x = targets_met(record, problem.prices, Aim::x, best);
  // A run that is below a declared f_L by more than rounding in single precision refutes it.
  constexpr Real kRounding = 1e-6;
  if (record.minimum && !record.is_best_known &&
      record.summary.best_loss <
          *record.minimum - kRounding * std::max(std::abs(*record.minimum), run.scale))
    loss.clear();
  run.loss_met = loss.size();
  run.x_met = x.size();
  run.targets = std::move(run.aim == Aim::x ? x : loss);
  run.targets.shrink_to_fit();
  run.returned_met = returned_targets(run, problem);
  return run;
}

// A run with two labels stands in two rows.
void fill_runs(Table& table, const OptimizerLabels& labels) {
  const auto problem = places(table.problems, &ProblemAxis::spec),
             optimizer = places(table.optimizers, &OptimizerAxis::label);
  const std::vector<Record>& records = table.study->runs;
  const BestKnown best(*table.study);
  std::vector<Run> read(records.size());
  share(records.size(), [&](std::size_t i) {
    const std::size_t p = problem.at(records[i].request.problem.spec);
    read[i] = run_of(records[i], table.problems[p], best);
    read[i].problem = p;
  });
  std::unordered_set<std::string> answered;
  for (Run& run : read) {
    const Request& request = run.record->request;
    answered.insert(run.record->cell);
    const std::vector<std::string> names = labels.of(request.problem.spec, labels.wholes(request));
    for (std::size_t i = 0; i < names.size(); ++i) {
      run.optimizer = optimizer.at(names[i]);
      run.is_repeated = i > 0;
      if (i + 1 < names.size())
        table.runs.push_back(run);
      else
        table.runs.push_back(std::move(run));
    }
  }
  for (const PlannedCell& cell : table.study->plan.cells) {
    if (answered.contains(cell.cell)) {
      ++table.answered;
      continue;
    }
    table.missing.push_back(cell);
    for (const std::string& name :
         labels.of(cell.problem, labels.wholes(cell.problem, cell.optimizer)))
      table.absent.push_back({.problem = problem.at(cell.problem),
                              .optimizer = optimizer.at(name),
                              .seed = cell.seed,
                              .targets = {}});
  }
  table.planned = table.study->plan.cells.size();
  if (table.planned == 0) table.planned = table.answered = records.size();
}

void count_runs(Table& table) {
  std::set<std::uint64_t> seeds;
  for (std::size_t row = 0; row < table.runs.size(); ++row) {
    const Run& run = table.runs[row];
    if (run.is_repeated) continue;
    const Status status = run.record->status;
    ++table.statuses[status];
    if (is_failure(status)) table.failures.push_back(row);
    seeds.insert(run.seed);
    table.is_any_timed_together = table.is_any_timed_together || !run.is_timed_alone;
  }
  table.seeds.assign(seeds.begin(), seeds.end());
}

// The settings of a problem that more than half of its methods were run on: a method that lacks one
// of them is not compared on the rest. Without a plan, half are enough.
std::set<std::uint64_t> usual_seeds(const std::vector<std::set<std::uint64_t>>& asked,
                                    bool has_plan) {
  std::map<std::uint64_t, std::size_t> counts;
  std::size_t methods = 0;
  for (const auto& seeds : asked) {
    methods += !seeds.empty();
    for (const std::uint64_t seed : seeds) ++counts[seed];
  }
  std::set<std::uint64_t> usual;
  for (const auto& [seed, count] : counts)
    if (2 * count > methods || (!has_plan && 2 * count == methods)) usual.insert(seed);
  return usual;
}

// Puts rows into cells and counts the seeds each cell lacks. They never got anywhere: leaving a run
// out betters no median. A curve that others made has the seeds that it has.
void fill_cells(const Table& table, Pivot& cells) {
  using Seeds = std::vector<std::vector<std::set<std::uint64_t>>>;  // [problem][optimizer]
  Seeds asked(table.problems.size(), {table.optimizers.size(), std::set<std::uint64_t>()});
  for (std::size_t row = 0; row < table.runs.size(); ++row) {
    const Run& run = table.runs[row];
    cells[run.problem][run.optimizer].runs.push_back(row);
    asked[run.problem][run.optimizer].insert(run.seed);
  }
  for (const Run& run : table.absent) asked[run.problem][run.optimizer].insert(run.seed);
  for (std::size_t p = 0; p < cells.size(); ++p) {
    const auto usual = usual_seeds(asked[p], !table.study->plan.cells.empty());
    for (std::size_t s = 0; s < cells[p].size(); ++s) {
      std::set<std::uint64_t>& all = asked[p][s];
      if (all.empty()) continue;
      const bool is_imported = std::ranges::all_of(cells[p][s].runs, [&](std::size_t row) {
        return table.runs[row].record->imported.has_value();
      });
      if (!is_imported || cells[p][s].runs.empty()) all.insert(usual.begin(), usual.end());
      for (const std::size_t row : cells[p][s].runs) all.erase(table.runs[row].seed);
      cells[p][s].planned = cells[p][s].runs.size() + all.size();
    }
  }
}

void fill_medians(const Table& table, Cell& cell) {
  const auto median_to = [&](Measure by, std::size_t target) {
    return table
        .aggregate(
            cell.runs, [&](const Run& run) { return run.taken(by, target); }, cell.missing())
        .median;
  };
  for (std::size_t j = 0; j < kTargets && median_to(Measure::work, j) < kNever; ++j)
    for (const Measure by : kMeasures)
      cell.medians[static_cast<std::size_t>(by)].push_back(median_to(by, j));
}

void aggregate(const Table& table, const Yardstick& yardstick, Cell& cell) {
  if (cell.runs.empty()) return;
  bool is_truth_known = false;
  for (const std::size_t row : cell.runs) {
    const Run& run = table.runs[row];
    ++cell.statuses[run.record->status];
    cell.failed += is_failure(run.record->status);
    is_truth_known = is_truth_known || !std::isnan(run.record->summary.start_x_error);
    cell.is_timed_alone = cell.is_timed_alone && run.is_timed_alone;
    add_missing(cell.privileges, run.record->privileges);
  }
  if (cell.statuses[Status::inapplicable] == cell.runs.size()) {
    const std::string& reason = table.runs[cell.runs[0]].record->message;
    cell.inapplicable = reason.empty() ? "the reason is not stated" : reason;
    return;
  }
  std::erase_if(cell.statuses, [](const auto& status) { return status.second == 0; });
  fill_medians(table, cell);
  for (std::size_t t = 0; t < kTolerances.size(); ++t) {
    const std::size_t target = yardstick.tolerances[t].rung;
    for (const Measure by : kMeasures)
      cell.taken[by][t] = table.aggregate(
          cell.runs, [&](const Run& run) { return run.taken(by, target); }, cell.missing());
    cell.is_bound[t] = std::ranges::any_of(cell.runs, [&](std::size_t row) {
      const std::vector<Reached>& targets = table.runs[row].targets;
      return target < targets.size() && targets[target].is_bound;
    });
  }
  cell.headline = cell.taken[yardstick.by];
  cell.loss = table.aggregate(cell.runs, [](const Run& run) { return run.record->summary.loss; });
  if (is_truth_known)
    cell.x_error =
        table.aggregate(cell.runs, [](const Run& run) { return run.record->summary.x_error; });
}

}  // namespace

std::vector<std::string> brief_labels(const std::vector<std::string>& labels) {
  std::vector<Label> parsed;
  std::map<std::string, std::vector<Label>> methods;
  for (const std::string& label : labels) {
    parsed.push_back(label_of(label));
    methods[parsed.back().spec.name].push_back(parsed.back());
  }
  std::vector<std::string> brief;
  std::map<std::string, int> count;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool is_short = labels[i].size() <= kLong;
    brief.push_back(is_short ? labels[i] : label_text(parsed[i], methods[parsed[i].spec.name]));
    ++count[brief.back()];
  }
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (count[brief[i]] > 1) brief[i] = labels[i];
  return brief;
}

std::string budget_options(const Request& request) {
  const Budget& budget = request.budget;
  std::string options = fmt::format("--iterations {}", budget.iterations);
  if (budget.work < Budget{}.work) options += fmt::format(" --work {}", budget.work);
  if (budget.seconds < Budget{}.seconds) options += fmt::format(" --time {}s", budget.seconds);
  if (budget.target != Budget{}.target) options += fmt::format(" --target {}", budget.target);
  if (budget.stall)
    options += " --stall " + (*budget.stall > 0 ? std::to_string(*budget.stall) : "never");
  if (budget.discrepancy > 0)
    options += fmt::format(" --stop 'discrepancy[tau={}]'", budget.discrepancy);
  if (request.threads != 1) options += fmt::format(" --threads {}", request.threads);
  return options;
}

std::string marks_text(const Marks& marks) {
  return std::string(marks.is_foreign ? " ‡" : "") + (marks.has_extra_information ? " †" : "") +
         (marks.is_imported ? " §" : "");
}

Real Run::spent_by(Measure by) const {
  const Summary& all = record->summary;
  return std::array{Real(all.work), spent, Real(all.iterations),
                    all.wall_seconds}[static_cast<std::size_t>(by)];
}

std::vector<Real> losses_left(const Run& run) {
  std::vector<Real> left;
  for (const Real loss : run.record->curve.loss)
    left.push_back(run.scale > 0 ? std::max(loss - run.minimum, 0.0) / run.scale : kNever);
  return left;
}

Real returned_digits(const Record& record) {
  if (is_failure(record.status)) return 0;
  return log_relative_error(record.summary.x_error / record.x_scale.value_or(1));
}

Table table_of(const Study& study) {
  const OptimizerLabels labels(study);
  Table table{.study = &study,
              .problems = problem_axis(study),
              .optimizers = optimizer_axis(study, labels)};
  fill_runs(table, labels);
  count_runs(table);
  return table;
}

Pivot pivot(const Table& table, const Yardstick& yardstick) {
  Pivot cells(table.problems.size(), std::vector<Cell>(table.optimizers.size()));
  fill_cells(table, cells);
  share(cells.size(), [&](std::size_t p) {
    for (Cell& cell : cells[p]) aggregate(table, yardstick, cell);
  });
  return cells;
}

void add_missing(std::vector<std::string>& all, const std::vector<std::string>& some) {
  for (const std::string& one : some)
    if (std::ranges::find(all, one) == all.end()) all.push_back(one);
}

std::map<std::string, std::vector<std::size_t>> problems_by_family(const Table& table) {
  std::map<std::string, std::vector<std::size_t>> families;
  for (std::size_t p = 0; p < table.problems.size(); ++p)
    families[table.problems[p].family()].push_back(p);
  return families;
}

}  // namespace isoline::results
