// Turns the pairs of a report.json into subjects of a comparison.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/spec.h"
#include "reports/compare/subject.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

void add_median(Subject& subject, const std::string& group, const std::string& name,
                const Json& spread) {
  const Json& median = spread.at("median");
  subject.quantities.push_back(
      {.group = group, .name = "median " + name, .value = real_of(median)});
  subject.quantities.push_back(
      {.group = group, .name = "runs without " + name, .value = real_of(spread.at("unsolved"))});
}

Given given(const std::string& label) {
  return {.name = name_of_spec(label), .asked = label, .spec = label, .options = {}};
}

Subject subject_of_pair(const Json& cell) {
  const auto text = [&](const char* key) { return cell.at(key).get<std::string>(); };
  Subject subject;
  subject.problem = given(text("problem"));
  subject.optimizer = given(text("optimizer"));
  subject.key = text("problem") + " × " + text("optimizer");
  subject.title = shown_spec(text("problem")) + " × " + shown_spec(text("optimizer"));
  subject.lost = cell.at("failed").get<std::size_t>();
  for (const auto& [status, count] : cell.at("statuses").items()) {
    subject.state +=
        fmt::format("{}{} {}", subject.state.empty() ? "" : ", ", status, json_text(count));
    if (status == "inapplicable") subject.lost += count.get<std::size_t>();
  }
  subject.badness = static_cast<int>(subject.lost);
  subject.asked = cell.value("asked", std::string());
  for (const Json& build : cell.value("builds", Json::array())) subject.builds.insert(build);
  if (!cell.contains("figures")) return subject;
  const Json& figures = cell.at("figures");
  add_median(subject, "loss", "loss", figures.at("loss"));
  if (figures.contains("x_error"))
    add_median(subject, "error in x", "error in x", figures.at("x_error"));
  for (const auto& [tau, median] : figures.at("work").items())  // of the report's own yardstick
    add_median(subject, "work", "work to " + figure(std::stod(tau)), median);
  return subject;
}

}  // namespace

std::vector<Subject> subjects_of_report(const Json& report) {
  try {
    require(report.at("schema") == kReportSchema,
            [&] { return fmt::format("the schema is not {}", kReportSchema); });
    std::vector<Subject> all;
    for (const Json& cell : report.at("cells")) all.push_back(subject_of_pair(cell));
    return all;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("no {} report: {}", kReportSchema, error.what()));
  }
}

}  // namespace isoline::reports
