// Result folders and plain records for the tests of reports.
#include "tests/reports/fixture.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/spec.h"
#include "core/status.h"

namespace isoline::reports {

namespace {

Hits hits_of(const PlainRun& run) {
  Hits hits;
  for (std::size_t j = 0; j < 51; ++j) {
    const bool is_met = j < run.hits;
    const std::int64_t work = is_met ? static_cast<std::int64_t>(j) * run.work_per_hit : -1;
    hits.target.push_back(rung(j));
    hits.iteration.push_back(is_met ? static_cast<std::int64_t>(j) : -1);
    hits.work.push_back(work);
    hits.forwards.push_back(work);
    hits.wall_seconds.push_back(is_met ? 1e-5 * static_cast<Real>(work) : NAN);
  }
  return hits;
}

Curve curve_of(const PlainRun& run) {
  Curve curve;
  for (std::size_t j = 0; j < run.hits; ++j) {
    const auto k = static_cast<std::int64_t>(j);
    curve.iteration.push_back(k);
    curve.work.push_back(k * run.work_per_hit);
    curve.wall_seconds.push_back(1e-5 * static_cast<Real>(k * run.work_per_hit));
    curve.processor_seconds.push_back(curve.wall_seconds.back());
    curve.loss.push_back(rung(j));
    curve.x_error.push_back(std::sqrt(curve.loss.back()));
    curve.gradient_norm.push_back(curve.x_error.back());
    curve.step_norm.push_back(0.1 * curve.x_error.back());
  }
  return curve;
}

}  // namespace

ResultFolder::ResultFolder() {
  for (const char* part : {"runs", "components"})
    std::filesystem::create_directories(path() / part);
}

void ResultFolder::add(const Record& record) const {
  add_file("runs/" + record.file_name(), to_json(record).dump());
}
void ResultFolder::add(const Sheet& sheet) const {
  add_file("components/" + sheet.file_name(), to_json(sheet).dump());
}
void ResultFolder::add(const Plan& plan) const { add_file("plan.json", to_json(plan).dump()); }
void ResultFolder::add_file(const std::string& name, const std::string& text) const {
  write_text(path() / name, text);
}

Record record_of(const PlainRun& run) {
  Record record;
  record.request.problem = {.name = name_of_spec(run.problem), .spec = run.problem};
  record.request.optimizer = {.name = name_of_spec(run.optimizer), .spec = run.optimizer};
  record.request.problem.options.set("spec", run.problem);  // tells the cells apart
  record.request.optimizer.options.set("spec", run.optimizer);
  record.request.seed = run.seed;
  record.cell = cell_digest(record.request);
  record.build = run.build;
  record.status = run.status;
  record.message = run.message;
  record.minimum = 0;
  record.curve = curve_of(run);
  record.hits = hits_of(run);
  const bool has_curve = !record.curve.loss.empty();
  const auto iterations = static_cast<std::int64_t>(std::max<std::size_t>(run.hits, 1) - 1);
  record.summary = {.iterations = iterations,
                    .work = iterations * run.work_per_hit,
                    .start_loss = 1,
                    .loss = has_curve ? record.curve.loss.back() : NAN,
                    .best_loss = has_curve ? record.curve.loss.back() : NAN,
                    .start_x_error = 1,
                    .x_error = has_curve ? record.curve.x_error.back() : NAN,
                    .gradient_norm = has_curve ? record.curve.gradient_norm.back() : NAN};
  record.provenance = Provenance(Build{.commit = "abc"});
  record.provenance.run.started = run.started;
  return record;
}

Plan plan_of(const std::vector<Record>& records) {
  Plan plan{.suites = {"test"}, .cells = {}};
  for (const Record& record : records)
    plan.cells.push_back({record.cell, record.request.problem.spec, record.request.optimizer.spec,
                          record.request.seed});
  return plan;
}

Study study_of(const std::vector<Result>& results) {
  Study study;
  for (const auto& [problem, optimizer, per_hit] : results)
    study.runs.push_back(record_of({.problem = problem,
                                    .optimizer = optimizer,
                                    .hits = per_hit == 0 ? 10U : 51U,
                                    .work_per_hit = std::max(per_hit, 1)}));
  return study;
}

Compared::Compared(Study study_of_all, const Yardstick& by)
    : OwnedStudy{std::move(study_of_all)}, Comparison(compare_optimizers(owned, by)) {}

Compared::Compared(std::vector<Record> records, const Yardstick& by)
    : Compared(Study{.runs = std::move(records)}, by) {}

std::string at(const Table& table, const std::string& row, const std::string& column) {
  const auto i = std::ranges::find(table.columns, column) - table.columns.begin();
  for (const auto& cells : table.rows)
    if (cells[0].text == row) return cells.at(static_cast<std::size_t>(i)).text;
  return "no such row";
}

}  // namespace isoline::reports
