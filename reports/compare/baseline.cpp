// Writes what a gate remembers of a study, and reads it back as subjects of a comparison.
#include "reports/compare/baseline.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "reports/compare/chaos.h"

namespace isoline::reports {
namespace {

Json work_json(const Record& record, const BestKnown& best) {
  Run run{.record = &record};
  fill_reached(run, best);
  return json_numbers(run.reached_loss[Measure::work]);
}

Json cell_json(const Record& record, const Subject& subject, const BestKnown& best) {
  Json cell = {{"cell", subject.key},
               {"title", subject.title},
               {"status", subject.state},
               {"build", record.build}};
  if (subject.is_nondeterministic) cell["nondeterministic"] = true;
  if (record.status == Status::inapplicable) return cell;
  const Summary& summary = record.summary;
  cell["trace"] = subject.trace;
  cell["loss"] = json_number(summary.loss);
  cell["best_loss"] = json_number(summary.best_loss);
  cell["start_loss"] = json_number(summary.start_loss);
  if (!std::isnan(summary.start_x_error)) {
    cell["x_error"] = json_number(summary.x_error);
    cell["start_x_error"] = json_number(summary.start_x_error);
  }
  cell["work"] = work_json(record, best);
  return cell;
}

Json to_json(const Perturbed& perturbed) {
  const Real moved = std::isfinite(perturbed.moved)
                         ? std::stod(fmt::format("{:.2e}", perturbed.moved))  // a measured size
                         : perturbed.moved;
  return {{"moved", json_number(moved)},
          {"statuses", perturbed.states},
          {"reached", perturbed.reached}};
}

Perturbed perturbed_from_json(const Json& json) {
  Perturbed perturbed{.moved = real_of(json.at("moved"))};
  json.at("statuses").get_to(perturbed.states);
  json.at("reached").get_to(perturbed.reached);
  for (const std::string& state : perturbed.states) status_named(state);  // refuses what is none
  return perturbed;
}

void add_figures(Subject& subject, const Json& cell) {
  const auto real = [&](const char* key) { return real_of(cell.at(key)); };
  subject.trace = cell.at("trace").get<std::string>();
  subject.quantities = {loss_quantity("loss", real("loss"), real("start_loss")),
                        loss_quantity("best loss", real("best_loss"), real("start_loss"))};
  if (cell.contains("x_error"))
    subject.quantities.push_back(x_error_quantity(real("x_error"), real("start_x_error")));
  const Json& work = cell.at("work");
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    subject.quantities.push_back(work_quantity(kTolerances[t].tau, real_of(work.at(t))));
}

Subject subject_from_json(const Json& cell) {
  const Status status = status_named(cell.at("status").get<std::string>());
  Subject subject = subject_that_ended(status);
  subject.key = cell.at("cell").get<std::string>();
  subject.title = cell.at("title").get<std::string>();
  subject.builds = {cell.at("build").get<std::string>()};
  subject.is_nondeterministic = cell.value("nondeterministic", false);
  if (status != Status::inapplicable) add_figures(subject, cell);
  if (cell.contains("perturbed")) subject.perturbed = perturbed_from_json(cell.at("perturbed"));
  return subject;
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

BestKnown minima_from_json(const Json& minima) {
  BestKnown::Minima least;
  for (const Json& one : minima)
    least[{one.at("problem").get<std::string>(), one.at("seed").get<std::uint64_t>()}] =
        real_of(one.at("loss"));
  return BestKnown(std::move(least));
}

}  // namespace

std::string baseline_json(const Study& study, const std::vector<Study>& perturbed) {
  const BestKnown best(study);
  const std::vector<Subject> subjects = subjects_of(study, best);
  std::map<std::string, std::vector<Subject>> moved;
  for (const Study& one : perturbed)
    for (Subject& subject : subjects_of(one, best))
      moved[subject.key].push_back(std::move(subject));
  std::string text = fmt::format(
      "{{\"schema\": \"{}\",\n\"suites\": {}, \"perturbations\": {},\n\"minima\": {},\n"
      "\"cells\": [",
      kBaselineSchema, Json(study.plan.suites).dump(), perturbed.size(),
      minima_json(study, best).dump());
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    Json cell = cell_json(study.runs[i], subjects[i], best);
    const Perturbed others = perturbed_of(subject_from_json(cell), moved[subjects[i].key]);
    if (others.moved > 0) cell["perturbed"] = to_json(others);
    text += (i == 0 ? "\n" : ",\n") + cell.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  return text + "\n]}\n";
}

Baseline baseline_from_json(const Json& json) {
  try {
    require(json.at("schema") == kBaselineSchema,
            [&] { return fmt::format("the schema is not {}", kBaselineSchema); });
    Baseline baseline{.subjects = {}, .minima = minima_from_json(json.at("minima"))};
    for (const Json& cell : json.at("cells")) baseline.subjects.push_back(subject_from_json(cell));
    return baseline;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("no {}: {}", kBaselineSchema, error.what()));
  }
}

}  // namespace isoline::reports
