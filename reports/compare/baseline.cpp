// Writes what a gate remembers of a study. What many cells share stands in tables at the top, and a
// cell names its rows.
#include "reports/compare/baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/options.h"
#include "core/spec.h"
#include "reports/compare/differences.h"

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

// Reads what a gate remembers back, as subjects of a comparison.

namespace {

Given given_from_json(const Json& json) {
  Given given{.name = json.at("name").get<std::string>(),
              .asked = "",
              .spec = json.at("spec").get<std::string>(),
              .options = option_values_from(json.at("options"))};
  given.asked = json.value("asked", given.spec);
  return given;
}

Perturbed perturbed_from_json(const Json& json) {
  Perturbed perturbed{.moved = real_of(json.at("moved"))};
  json.at("statuses").get_to(perturbed.states);
  json.at("reached").get_to(perturbed.reached);
  for (const std::string& state : perturbed.states) status_named(state);  // refuses what is none
  return perturbed;
}

void read_figures(Subject& subject, const Json& cell) {
  const auto real = [&](const char* key) { return real_of(cell.at(key)); };
  const auto add_works = [&](const char* key, Quantity (*quantity)(Real, Real)) {
    for (std::size_t t = 0; t < kTolerances.size(); ++t)
      subject.quantities.push_back(quantity(kTolerances[t].tau, real_of(cell.at(key).at(t))));
  };
  subject.trace = cell.at("trace").get<std::string>();
  subject.rest = cell.value("rest", std::string());
  subject.quantities = {loss_quantity("loss", real("loss"), real("scale")),
                        loss_quantity("best loss", real("best_loss"), real("scale"))};
  if (cell.contains("x_error"))
    subject.quantities.push_back(x_error_quantity(real("x_error"), real("x_scale")));
  add_works("work", work_quantity);
  if (cell.contains("found")) add_works("found", found_quantity);
}

void read_question(Subject& subject, const Json& cell, const Json& file) {
  const auto seed = cell.at("seed").get<std::uint64_t>();
  const auto given = [&](std::size_t side) {
    return given_from_json(file.at("given").at(cell.at("given").at(side).get<std::size_t>()));
  };
  subject.problem = given(0);
  subject.optimizer = given(1);
  subject.title = title_of(subject.problem, subject.optimizer, seed);
  subject.terms =
      fmt::format("seed {}, {}", seed,
                  file.at("terms").at(cell.at("terms").get<std::size_t>()).get<std::string>());
  BuildParts parts;
  for (const Json& place : cell.value("parts", Json::array())) {
    const Json& part = file.at("parts").at(place.get<std::size_t>());
    parts[part.at(0).get<std::string>()] = part.at(1).get<std::string>();
  }
  subject.parts = std::move(parts);
}

Subject subject_from_json(const Json& cell, const Json& file) {
  const Status status = status_named(cell.at("status").get<std::string>());
  Subject subject = subject_that_ended(status);
  subject.key = cell.at("cell").get<std::string>();
  read_question(subject, cell, file);
  subject.builds = {cell.at("build").get<std::string>()};
  subject.aim = aim_of(cell.value("aim", std::string("loss"))).value_or(Aim::loss);
  subject.is_cut = cell.value("nondeterministic", false);
  if (status != Status::inapplicable) read_figures(subject, cell);
  if (cell.contains("perturbed")) subject.perturbed = perturbed_from_json(cell.at("perturbed"));
  return subject;
}

BestKnown minima_from_json(const Json& minima) {
  BestKnown::Minima least;
  for (const Json& one : minima)
    least[{one.at("problem").get<std::string>(), one.at("seed").get<std::uint64_t>()}] =
        real_of(one.at("loss"));
  return BestKnown(std::move(least));
}

}  // namespace

Baseline baseline_from_json(const Json& json) {
  try {
    require(json.at("schema") == kBaselineSchema,
            [&] { return fmt::format("the schema is not {}", kBaselineSchema); });
    Baseline baseline{.subjects = {}, .minima = minima_from_json(json.at("minima"))};
    for (const Json& cell : json.at("cells"))
      baseline.subjects.push_back(subject_from_json(cell, json));
    return baseline;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("no {}: {}", kBaselineSchema, error.what()));
  }
}

}  // namespace isoline::reports
