// Turns records into subjects of a comparison.
#include "reports/compare/subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/options.h"
#include "core/threads.h"
#include "reports/read/study.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

bool is_lost(Status status) { return is_failure(status) || status == Status::inapplicable; }

// f₀ − f_L where older records lack it; not-a-number where nothing is known.
Real scale_of(const Record& record, const BestKnown& reference) {
  return record.scale.value_or(record.summary.start_loss - reference.minimum(record));
}

// Read at kept iterations, where a record has no hits.
Real work_until_reached(const Record& record, const BestKnown& reference, Real tau) {
  const Real goal = reference.minimum(record) + tau * scale_of(record, reference);
  const Curve& curve = record.curve;
  for (std::size_t i = 0; i < curve.loss.size(); ++i)
    if (std::isfinite(curve.loss[i]) && curve.loss[i] <= goal) return Real(curve.work[i]);
  return kNever;
}

void add_work(Subject& subject, const Record& record, const BestKnown& reference) {
  if (record.hits) {
    const Hits& hits = *record.hits;
    for (std::size_t j = 0; j < hits.target.size(); ++j)
      subject.quantities.push_back(
          work_quantity(hits.target[j], hits.iteration[j] < 0 ? kNever : Real(hits.work[j])));
    return;
  }
  for (const Tolerance& tolerance : kTolerances)
    subject.quantities.push_back(
        work_quantity(tolerance.tau, work_until_reached(record, reference, tolerance.tau)));
}

// Read at kept iterations.
Real work_until_found(const Record& record, Real tau) {
  const Real goal = x_goal(tau, *record.x_scale, record.x_floor);
  const Curve& curve = record.curve;
  for (std::size_t i = 0; i < curve.x_error.size(); ++i)
    if (curve.x_error[i] <= goal) return Real(curve.work[i]);
  return kNever;
}

void add_x(Subject& subject, const Record& record) {
  const Summary& summary = record.summary;
  if (std::isnan(summary.start_x_error)) return;
  subject.quantities.push_back(
      x_error_quantity(summary.x_error, record.x_scale.value_or(summary.start_x_error)));
  if (!record.x_scale) return;
  for (const Tolerance& tolerance : kTolerances)
    subject.quantities.push_back(
        found_quantity(tolerance.tau, work_until_found(record, tolerance.tau)));
}

std::string digest_of(const Json& json) { return digest(json_text(json)); }

// The path apart from the rest, so that each is called by its name.
void add_digests(Subject& subject, const Record& record) {
  Json json = result_of(to_json(record));
  for (const char* known : {"build", "build_parts", "cell", "schema"}) json.erase(known);
  Json path = Json::object();
  for (const char* name : {"curve", "trajectory", "series", "exhibit", "hits"})
    if (json.contains(name)) {
      path[name] = std::move(json[name]);
      json.erase(name);
    }
  subject.trace = digest_of(path);
  for (const auto& [name, value] : json.items())
    subject.members.emplace_back(name, fnv1a(json_text(value)));
  subject.rest = digest_of(json);
}

Given given(const Component& component) {
  return {.name = component.name,
          .asked = component.asked.empty() ? component.spec : component.asked,
          .spec = component.spec,
          .options = component.options};
}

std::string terms_of(const Request& request) {
  return fmt::format("seed {}, budget {}, threads {}", request.seed,
                     json_text(to_json(request).at("budget")), request.threads);
}

bool is_cut(const Record& record) {
  return record.is_nondeterministic || record.status == Status::timeout ||
         record.status == Status::interrupted;
}

void add_seconds(Subject& subject, const std::vector<Real>& seconds) {
  for (const Real value : seconds)
    if (std::isfinite(value) && value > 0)
      subject.seconds.push_back(value);
    else
      ++subject.senseless_times;
}

Subject subject_of(const Record& record, const BestKnown& reference) {
  Subject subject = subject_without_figures(record);
  add_figures(subject, record, reference);
  return subject;
}

}  // namespace

std::string key_of(const OptionValues& options) { return json_text(isoline::to_json(options)); }

std::string key_of(const std::map<std::string, std::string>& texts) {
  std::string key;
  for (const auto& [name, text] : texts) key.append(name).append("=").append(text).append("\n");
  return key;
}

Subject subject_without_figures(const Record& record) {
  const Request& request = record.request;
  Subject subject = subject_that_ended(record.status);
  subject.key = record.cell;
  subject.problem = given(request.problem);
  subject.optimizer = given(request.optimizer);
  subject.title = title_of(subject.problem, subject.optimizer, request.seed);
  subject.terms = terms_of(request);
  subject.builds = {record.build};
  subject.parts = record.build_parts;
  subject.aim = record.aim;
  subject.is_cut = is_cut(record);
  subject.processor = record.provenance.build->processor;
  if (const std::string cell = cell_digest(request); cell != record.cell)
    subject.doubt = fmt::format("its cell is not the digest of its request, {}", cell);
  if (record.status == Status::inapplicable) return subject;
  add_seconds(subject, record.repeat_wall_seconds);
  add_digests(subject, record);
  return subject;
}

void add_figures(Subject& subject, const Record& record, const BestKnown& reference) {
  if (record.status == Status::inapplicable) return;
  const Summary& summary = record.summary;
  const Real scale = scale_of(record, reference);
  subject.quantities = {loss_quantity("loss", summary.loss, scale),
                        loss_quantity("best loss", summary.best_loss, scale)};
  add_x(subject, record);
  add_work(subject, record, reference);
  subject.quantities.shrink_to_fit();
}

// Two that are equally bad may still differ: that is a change, and no verdict.
int badness_of(Status status) {
  if (status == Status::target || status == Status::converged) return 0;
  if (status == Status::budget || status == Status::stalled) return 1;
  if (status == Status::diverged) return 2;
  return 3;
}

Subject subject_that_ended(Status status) {
  Subject subject;
  subject.state = std::string(name_of(status));
  subject.badness = badness_of(status);
  subject.lost = is_lost(status);
  return subject;
}

Status status_named(const std::string& name) {
  const std::optional<Status> status = status_of(name);
  require(status.has_value(), [&] { return fmt::format("unknown status '{}'", name); });
  return *status;
}

std::string title_of(const Given& problem, const Given& optimizer, std::uint64_t seed) {
  return fmt::format("{} × {}, seed {}", shown_spec(problem.spec), shown_spec(optimizer.spec),
                     seed);
}

Quantity loss_quantity(const std::string& name, Real loss, Real scale) {
  return {.group = "loss", .name = name, .value = loss, .scale = scale};
}

Quantity x_error_quantity(Real x_error, Real scale) {
  return {.group = "error in x", .name = "error in x", .value = x_error, .scale = scale};
}

Quantity work_quantity(Real tau, Real work) {
  return {.group = "work", .name = "work to " + figure(tau), .value = work};
}

Quantity found_quantity(Real tau, Real work) {
  return {.group = "work to x", .name = "work to x within " + figure(tau), .value = work};
}

Real work_to(const Subject& subject, Aim aim, Real tau) {
  const Quantity wanted = aim == Aim::x ? found_quantity(tau, kNever) : work_quantity(tau, kNever);
  const auto at = std::ranges::find(subject.quantities, wanted.name, &Quantity::name);
  return at == subject.quantities.end() ? kNever : at->value;
}

std::vector<Subject> subjects_of(const Study& study, const BestKnown& reference) {
  std::vector<Subject> all(study.runs.size());
  share(all.size(), [&](std::size_t i) {
    all[i] = subject_of(study.runs[i], reference);
    if (study.disputed.contains(all[i].key))
      all[i].doubt = "two records of this cell and build differ";
  });
  return all;
}

// Makes a subject of each record as it is read, and forgets the record.

namespace {

// What is left of a record.
struct Reading {
  RunMark mark;  // without a cell where it could not be read
  Subject subject;
  Real best_loss = kNever;
  std::unique_ptr<const Record> figures;  // while f_L, which its figures need, is not known
};

// A record with what its figures are made of, and no more.
std::unique_ptr<const Record> figures_of(Record record) {
  auto figures = std::make_unique<Record>();
  figures->request.problem.spec = record.request.problem.spec;
  figures->request.seed = record.request.seed;
  figures->status = record.status;
  figures->summary = record.summary;
  figures->scale = record.scale;
  figures->x_scale = record.x_scale;
  figures->x_floor = record.x_floor;
  figures->hits = std::move(record.hits);
  figures->curve.work = std::move(record.curve.work);
  figures->curve.loss = std::move(record.curve.loss);
  figures->curve.x_error = std::move(record.curve.x_error);
  return figures;
}

Reading read(const std::string& file, const std::optional<BestKnown>& reference) {
  static const BestKnown kNone{BestKnown::Minima{}};
  Reading reading;
  try {
    Record record = read_record(file);
    reading.subject = subject_without_figures(record);
    if (record.status != Status::inapplicable) reading.best_loss = record.summary.best_loss;
    reading.mark = mark_of(record);
    if (reference || record.minimum || record.status == Status::inapplicable)
      add_figures(reading.subject, record, reference ? *reference : kNone);
    else
      reading.figures = figures_of(std::move(record));
  } catch (const std::exception&) {
    reading.mark.cell.clear();
  }
  return reading;
}

bool files_are_at_odds(const std::string& a, const std::string& b) {
  return are_at_odds(read_record(a), read_record(b));
}

BestKnown best_of(const std::vector<Reading>& readings, const std::vector<std::size_t>& kept) {
  BestKnown::Minima minima;
  for (const std::size_t i : kept) {
    const RunMark& mark = readings[i].mark;
    Real& least = minima.emplace(std::pair(mark.problem, mark.seed), kNever).first->second;
    if (readings[i].best_loss < least) least = readings[i].best_loss;
  }
  return BestKnown(std::move(minima));
}

}  // namespace

FolderSubjects read_subjects(const std::string& folder, const std::optional<BestKnown>& reference,
                             const Listener& listener) {
  std::error_code unknown;
  require(std::filesystem::is_directory(folder, unknown),
          [&] { return folder + ": no such result folder"; });
  std::vector<Unreadable> unlisted;
  const std::vector<std::string> files = record_files({folder}, unlisted);
  std::vector<Reading> readings(files.size());
  share(
      files.size(), [&](std::size_t i) { readings[i] = read(files[i], reference); }, listener);
  std::vector<RunMark> marks;
  std::size_t unreadable = unlisted.size();
  for (const Reading& reading : readings) {
    marks.push_back(reading.mark);
    unreadable += reading.mark.cell.empty();
  }
  const Newest newest = newest_of(
      marks, [&](std::size_t i, std::size_t j) { return files_are_at_odds(files[i], files[j]); });
  FolderSubjects found{.subjects = std::vector<Subject>(newest.kept.size()),
                       .best = best_of(readings, newest.kept),
                       .unreadable = unreadable,
                       .superseded = newest.superseded};
  share(newest.kept.size(), [&](std::size_t k) {
    Reading& reading = readings[newest.kept[k]];
    if (reading.figures) add_figures(reading.subject, *reading.figures, found.best);
    if (newest.disputed.contains(reading.mark.cell))
      reading.subject.doubt = "two records of this cell and build differ";
    found.subjects[k] = std::move(reading.subject);
  });
  return found;
}

}  // namespace isoline::reports
