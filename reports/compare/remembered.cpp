// Reads what a gate remembers back, as subjects of a comparison.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/option_json.h"
#include "core/spec.h"
#include "reports/compare/baseline.h"

namespace isoline::reports {
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
  // Baselines of before knew the start, and no scale.
  const auto scale = [&](const char* key, const char* older) {
    return real(cell.contains(key) ? key : older);
  };
  const auto add_works = [&](const char* key, Quantity (*quantity)(Real, Real)) {
    for (std::size_t t = 0; t < kTolerances.size(); ++t)
      subject.quantities.push_back(quantity(kTolerances[t].tau, real_of(cell.at(key).at(t))));
  };
  subject.trace = cell.at("trace").get<std::string>();
  subject.rest = cell.value("rest", std::string());
  const Real loss_scale = scale("scale", "start_loss");
  subject.quantities = {loss_quantity("loss", real("loss"), loss_scale),
                        loss_quantity("best loss", real("best_loss"), loss_scale)};
  if (cell.contains("x_error"))
    subject.quantities.push_back(
        x_error_quantity(real("x_error"), scale("x_scale", "start_x_error")));
  add_works("work", work_quantity);
  if (cell.contains("found")) add_works("found", found_quantity);
}

// "sine × adam[rate=0.1], seed 0" is all that older baselines tell of what was asked.
void read_title(Subject& subject, const std::string& title) {
  const std::size_t cross = title.find(" × "), end = title.rfind(", seed ");
  if (cross == std::string::npos || end == std::string::npos) return;
  const std::size_t second = cross + std::string(" × ").size();
  const auto given = [](const std::string& spec) {
    return Given{.name = name_of_spec(spec), .asked = spec, .spec = spec, .options = {}};
  };
  subject.problem = given(title.substr(0, cross));
  subject.optimizer = given(title.substr(second, end - second));
  subject.title = title;
}

void read_question(Subject& subject, const Json& cell, const Json& file) {
  if (!cell.contains("given")) return read_title(subject, cell.at("title").get<std::string>());
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
