// Writes what a gate remembers of a study. What many cells share stands in tables at the top, and a
// cell names its rows.
#include "reports/compare/baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/option_json.h"
#include "reports/compare/chaos.h"

namespace isoline::reports {
namespace {

// Rows once each, in the order of their first use.
class Rows {
 public:
  std::size_t place(const Json& row) {
    const auto [at, is_new] = places_.emplace(json_text(row), rows_.size());
    if (is_new) rows_.push_back(row);
    return at->second;
  }
  std::string text() const {
    std::string text = "[";
    for (std::size_t i = 0; i < rows_.size(); ++i)
      text += (i == 0 ? "\n" : ",\n") + json_text(rows_[i]);
    return text + "]";
  }

 private:
  std::map<std::string, std::size_t> places_;
  std::vector<Json> rows_;
};

struct Tables {
  Rows given, terms, parts;
};

Json to_json(const Given& given) {
  Json json = {
      {"name", given.name}, {"spec", given.spec}, {"options", isoline::to_json(*given.options)}};
  if (given.asked != given.spec) json["asked"] = given.asked;
  return json;
}

// By the group of its quantity, infinite where it was never reached.
Json works_json(const Subject& subject, Aim aim) {
  std::vector<Real> works;
  for (const Tolerance& tolerance : kTolerances)
    works.push_back(work_to(subject, aim, tolerance.tau));
  return json_numbers(works);
}

bool has_group(const Subject& subject, const std::string& group) {
  return std::ranges::any_of(subject.quantities,
                             [&](const Quantity& quantity) { return *quantity.group == group; });
}

void add_figures(Json& cell, const Record& record, const Subject& subject) {
  const Summary& summary = record.summary;
  cell["trace"] = subject.trace;
  cell["rest"] = subject.rest;
  cell["loss"] = json_number(summary.loss);
  cell["best_loss"] = json_number(summary.best_loss);
  cell["scale"] = json_number(subject.quantities.at(0).scale);
  if (has_group(subject, "error in x")) {
    cell["x_error"] = json_number(summary.x_error);
    cell["x_scale"] = json_number(record.x_scale.value_or(summary.start_x_error));
  }
  cell["work"] = works_json(subject, Aim::loss);
  if (has_group(subject, "work to x")) cell["found"] = works_json(subject, Aim::x);
}

Json cell_json(const Record& record, const Subject& subject, Tables& tables) {
  const std::string seed = fmt::format("seed {}, ", record.request.seed);
  Json cell = {{"cell", subject.key},
               {"given",
                {tables.given.place(to_json(subject.problem)),
                 tables.given.place(to_json(subject.optimizer))}},
               {"seed", record.request.seed},
               {"terms", tables.terms.place(subject.terms.substr(seed.size()))},
               {"status", subject.state},
               {"build", record.build}};
  for (const auto& [name, digest] : *subject.parts)
    cell["parts"].push_back(tables.parts.place(Json{name, digest}));
  if (record.aim != Aim::loss) cell["aim"] = name_of(record.aim);
  if (subject.is_cut) cell["nondeterministic"] = true;
  if (record.status != Status::inapplicable) add_figures(cell, record, subject);
  return cell;
}

// With the targets that the file keeps, so that a cell moves by what a comparison will look at.
Subject remembered(Subject subject) {
  std::erase_if(subject.quantities, [](const Quantity& quantity) {
    return quantity.group == "work" &&
           std::ranges::none_of(kTolerances, [&](const Tolerance& tolerance) {
             return quantity.name == work_quantity(tolerance.tau, kNever).name;
           });
  });
  return subject;
}

Json to_json(const Perturbed& perturbed) {
  const Real moved = std::isfinite(perturbed.moved)
                         ? std::stod(fmt::format("{:.2e}", perturbed.moved))  // a measured size
                         : perturbed.moved;
  return {{"moved", json_number(moved)},
          {"statuses", perturbed.states},
          {"reached", perturbed.reached}};
}

Json minima_json(const Study& study, const BestKnown& best) {
  BestKnown::Minima undeclared;
  for (const Record& record : study.runs)
    if (!record.minimum && record.status != Status::inapplicable)
      undeclared[{record.request.problem.spec, record.request.seed}] = best.minimum(record);
  Json minima = Json::array();
  for (const auto& [key, least] : undeclared)
    minima.push_back({{"problem", key.first}, {"seed", key.second}, {"loss", json_number(least)}});
  return minima;
}

}  // namespace

std::string baseline_json(const Study& study, const std::vector<Study>& perturbed) {
  const BestKnown best(study);
  const std::vector<Subject> subjects = subjects_of(study, best);
  std::map<std::string, std::vector<Subject>> moved;
  for (const Study& one : perturbed)
    for (Subject& subject : subjects_of(one, best))
      moved[subject.key].push_back(std::move(subject));
  Tables tables;
  std::string cells;
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    Json cell = cell_json(study.runs[i], subjects[i], tables);
    const Perturbed others = perturbed_of(remembered(subjects[i]), moved[subjects[i].key]);
    if (others.moved > 0) cell["perturbed"] = to_json(others);
    cells += (i == 0 ? "\n" : ",\n") + json_text(cell);
  }
  return fmt::format(
      "{{\"schema\": \"{}\",\n\"suites\": {}, \"perturbations\": {},\n"
      "\"minima\": {},\n\"given\": {},\n\"terms\": {},\n\"parts\": {},\n\"cells\": [{}\n]}}\n",
      kBaselineSchema, json_text(Json(study.plan.suites)), perturbed.size(),
      json_text(minima_json(study, best)), tables.given.text(), tables.terms.text(),
      tables.parts.text(), cells);
}

}  // namespace isoline::reports
