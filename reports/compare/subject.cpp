// Turns records and reports into subjects of a comparison.
#include "reports/compare/subject.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/threads.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

bool is_lost(Status status) { return is_failure(status) || status == Status::inapplicable; }

void add_work(Subject& subject, const Record& record, const BestKnown& reference) {
  if (record.hits) {
    const Hits& hits = *record.hits;
    for (std::size_t j = 0; j < hits.target.size(); ++j)
      subject.quantities.push_back(
          work_quantity(hits.target[j], hits.iteration[j] < 0 ? kNever : Real(hits.work[j])));
    return;
  }
  Run run{.record = &record};
  fill_reached(run, reference);
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    subject.quantities.push_back(
        work_quantity(kTolerances[t].tau, run.reached_loss[Measure::work][t]));
}

std::string trace_of(const Record& record) {
  Json result = without_timings(to_json(record));
  result.erase("provenance");
  result.erase("build");
  result.at("request").erase("rates");
  return digest(result.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Subject subject_of(const Record& record, const BestKnown& reference) {
  const Request& request = record.request;
  const Summary& summary = record.summary;
  Subject subject = subject_that_ended(record.status);
  subject.key = record.cell;
  subject.title = fmt::format("{} × {}, seed {}", shown_spec(request.problem.spec),
                              shown_spec(request.optimizer.spec), request.seed);
  subject.builds = {record.build};
  subject.seconds = record.repeat_wall_seconds;
  subject.is_nondeterministic = record.is_nondeterministic;
  subject.processor = record.provenance.build->processor;
  if (record.status == Status::inapplicable) return subject;
  subject.trace = trace_of(record);
  subject.quantities = {loss_quantity("loss", summary.loss, summary.start_loss),
                        loss_quantity("best loss", summary.best_loss, summary.start_loss)};
  if (!std::isnan(summary.start_x_error))
    subject.quantities.push_back(x_error_quantity(summary.x_error, summary.start_x_error));
  add_work(subject, record, reference);
  return subject;
}

void add_median(Subject& subject, const std::string& group, const std::string& name,
                const Json& spread) {
  const Json& median = spread.at("median");
  subject.quantities.push_back(
      {.group = group, .name = "median " + name, .value = real_of(median)});
  subject.quantities.push_back(
      {.group = group, .name = "runs without " + name, .value = real_of(spread.at("unsolved"))});
}

Subject subject_of_pair(const Json& cell) {
  const auto text = [&](const char* key) { return cell.at(key).get<std::string>(); };
  Subject subject{.key = text("problem") + " × " + text("optimizer"),
                  .title = shown_spec(text("problem")) + " × " + shown_spec(text("optimizer")),
                  .lost = cell.at("failed").get<std::size_t>()};
  for (const auto& [status, count] : cell.at("statuses").items()) {
    subject.state +=
        fmt::format("{}{} {}", subject.state.empty() ? "" : ", ", status, count.dump());
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
  for (const Tolerance& tolerance : kTolerances)
    add_median(subject, "work", "work to " + figure(tolerance.tau),
               figures.at("work").at(std::string(tolerance.name)));
  return subject;
}

}  // namespace

// Two that are equally bad may still differ: that is a change, and no verdict.
int badness_of(Status status) {
  if (status == Status::target || status == Status::converged) return 0;
  if (status == Status::budget || status == Status::stalled) return 1;
  if (status == Status::diverged) return 2;
  return 3;
}

Subject subject_that_ended(Status status) {
  return {.key = "",
          .title = "",
          .state = std::string(name_of(status)),
          .badness = badness_of(status),
          .lost = is_lost(status)};
}

Status status_named(const std::string& name) {
  const std::optional<Status> status = status_of(name);
  require(status.has_value(), [&] { return fmt::format("unknown status '{}'", name); });
  return *status;
}

Quantity loss_quantity(const std::string& name, Real loss, Real start) {
  return {.group = "loss", .name = name, .value = loss, .scale = start};
}

Quantity x_error_quantity(Real x_error, Real start) {
  return {.group = "error in x", .name = "error in x", .value = x_error, .scale = start};
}

Quantity work_quantity(Real tau, Real work) {
  return {.group = "work", .name = "work to " + figure(tau), .value = work};
}

std::vector<Subject> subjects_of(const Study& study, const BestKnown& reference) {
  std::vector<Subject> all(study.runs.size());
  share(all.size(), [&](std::size_t i) { all[i] = subject_of(study.runs[i], reference); });
  return all;
}

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
