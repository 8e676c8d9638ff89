// Checks, stores, describes and runs a plan, and chooses the name of its folder.
#include "benchmarks/run/run_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "benchmarks/run/calls.h"
#include "benchmarks/run/sheets.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/foreign/evaluations.h"
#include "core/foreign/line.h"
#include "core/foreign/workers.h"
#include "core/json.h"
#include "core/output.h"
#include "core/records/json_view.h"
#include "core/seeds.h"
#include "optimizers/optimizer.h"
#include "problems/conformance.h"
#include "problems/problem.h"
#include "problems/wrapper.h"

namespace isoline::benchmarks {
namespace {

// Empty if every property holds.
std::string broken_property_of(const Catalog& catalog, const Request& request, Trace& trace) {
  const Problem problem = make_problem(catalog, request.problem, request.seed);
  RandomStream stream(request.seed, request.problem.name, "check");
  const auto show = [&](const problems::CheckProgress& now) {
    trace.last.iteration = static_cast<std::int64_t>(now.done);
    trace.last.work = static_cast<std::int64_t>(now.all);
    trace.last.wall_seconds = now.call_seconds;
    trace.last.counts[0] = now.calls;
  };
  for (const problems::Finding& finding : problems::examine(problem, stream, show))
    if (!finding.holds())
      return finding.limit == 0
                 ? fmt::format("check '{}' failed: {}", finding.property, finding.reason)
                 : fmt::format("check '{}' failed: {:.2e}, at most {:.1e} is allowed ({})",
                               finding.property, finding.figure, finding.limit, finding.reason);
  return "";
}

// The build that has passed its checks in an earlier run of this folder; empty if none has.
std::string certified_in(Store& store, const Component& problem) {
  const Sheet sheet{.kind = "problem", .name = problem.name, .spec = problem.spec};
  const std::filesystem::path file = store.folder() / "components" / sheet.file_name();
  if (is_there(file)) try {
      return sheet_from_text(read_text(file), file.string()).certified;
    } catch (const AccessError&) {  // it may be sound
    } catch (const UsageError& error) {
      store.set_aside(file, reason_of(error));
    }
  return "";
}

// "3 of 9 checks of SPEC", and of a slow program how many calls they make.
std::string checks_text(const TracePoint& now, const std::string& problem) {
  const std::string calls =
      now.counts[0] > 0
          ? fmt::format(" (about {} calls of {})", now.counts[0], duration_text(now.wall_seconds))
          : "";
  return fmt::format("{} of {} checks{} of {}", now.iteration, now.work, calls, problem);
}

// As broken_property_of. The store of evaluations answers what it can, and keeps its calls.
std::string checked(const Catalog& catalog, const Request& request, const Store& store,
                    const RunOptions& options, Trace& trace) {
  evaluations().begin(evaluations_of(options, request, store.folder()));
  limit_calls(request);
  return broken_property_of(catalog, request, trace);
}

EvaluationKey key_of(const Request& request) {
  const OptionValues& options = request.problem.options;
  return {options.text("command"), declared_values(options), instance_of(request.seed)};
}

void set_evaluations_aside(Store& store, const EvaluationKey& key) {
  for (const std::filesystem::path& file : evaluation_files(store.folder(), key.problem))
    store.set_aside(file, "the program answers differently now at a point in " + file.string());
}

// Whether y differs from a known one. Where two calls differ as much, the program has noise.
bool differs(const Matrix& known, const std::function<Matrix()>& ask) {
  constexpr Real kRelative = 1e-9, kTimesNoise = 10;
  const Afresh afresh;
  const auto distance = [](const Matrix& a, const Matrix& b) {
    if (a.allFinite() != b.allFinite()) return std::numeric_limits<Real>::infinity();
    return a.allFinite() ? (a - b).cwiseAbs().maxCoeff() : 0;
  };
  const Matrix now = ask();
  const Real change = distance(now, known);
  return change > kRelative * known.cwiseAbs().maxCoeff() &&
         change > kTimesNoise * distance(now, ask());
}

// Whether the program still answers as the store has it, at the start. What the program imports is
// not in the digest of its files: the store may be of an earlier version.
std::string answers_differently(const Catalog& catalog, const Request& request,
                                const Store& store) {
  evaluations().begin({.folder = store.folder()});
  limit_calls(request);
  const Problem problem = make_problem(catalog, request.problem, request.seed);
  const auto y_at_start = [&] {
    Point at;
    problem.forward(problem.start(), at);
    return Matrix(at.y);
  };
  const Matrix known = y_at_start();
  return call_report().answered > 0 && differs(known, y_at_start) ? "differs" : "";
}

// As a record of the fit of a user's data has it, at its returned point, and of the data.
std::string contradicts(const Catalog& catalog, const Request& request, const Store& store,
                        const Record& record) {
  evaluations().begin({.folder = store.folder()});
  limit_calls(request);
  const Problem problem = make_problem(catalog, request.problem, request.seed);
  const problems::Physics* physics = &problem.physics();
  while (const auto* outer = dynamic_cast<const problems::Wrapper*>(physics))
    physics = &outer->inside();
  const FitData& fit = *record.fit;
  const Eigen::Map<const Vector> y(fit.y.data(), std::ssize(fit.y)),
      target(fit.target.data(), y.size()),
      x(record.answer->point(kReturned).data(), record.answer->unknowns);
  if (physics->inputs() != x.size() || physics->outputs() != y.size()) return "differs";
  constexpr Real kRounding = 1e-12;
  Vector data = problem.target().topRows(y.size()).reshaped();
  const Vector factors = problem.factors_of_data();
  if (factors.size() == data.size()) data = data.cwiseQuotient(factors);
  if (!((data - target).norm() <= kRounding * target.norm())) return "differs";
  const auto y_at_answer = [&] {
    Workspace w;
    w.x = x;
    Matrix found(y.size(), 1);
    physics->forward(w.x, w.context, found, w);
    return found;
  };
  return differs(y, y_at_answer) ? "differs" : "";
}

// Each problem of another program that has records of this plan computes what one of them returned
// again; if it differs, they are set aside, and their cells run again. Adds these problems to
// `seen`. False where that was interrupted.
bool confirm_records(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                     const RunOptions& options, std::set<std::string>& seen) {
  std::map<std::string, bool> is_changed;  // by problem
  for (const Request& request : requests) {
    const Component& problem = request.problem;
    if (!is_elsewhere(problem) || options.force) continue;
    const auto known = is_changed.find(problem.spec);
    if (known != is_changed.end() && !known->second) continue;
    const std::optional<Record> record = store.find(request);
    if (!record || !record->fit || !record->answer || record->answer->point(kReturned).empty())
      continue;
    const auto [at, is_first] = is_changed.try_emplace(problem.spec, false);
    if (is_first) {
      seen.insert(key_of(request).problem);
      const auto found =
          isolated_text([&] { return contradicts(catalog, request, store, *record); },
                        text_seconds_of(problem, kForeignSeconds));
      if (found.is_interrupted || asked_to_end() != Asked::nothing) return false;
      at->second = found.text && !found.text->empty();
      if (at->second) set_evaluations_aside(store, key_of(request));
    }
    if (at->second)
      store.set_aside(store.folder() / "runs" / Store::name_of(request),
                      "its problem answers differently now, or has other data");
  }
  return true;
}

// Each problem of another program of which the store has evaluations computes one of them again,
// if it is not among those `seen`. False where that was interrupted.
bool confirm_evaluations(const Catalog& catalog, const std::vector<const Request*>& requests,
                         Store& store, const RunOptions& options, std::set<std::string> seen) {
  for (const Request* request : requests) {
    const Component& problem = request->problem;
    if (evaluations_of(options, *request, store.folder()).folder.empty() || options.force) continue;
    const EvaluationKey key = key_of(*request);
    if (evaluation_files(store.folder(), key.stem()).empty() || !seen.insert(key.problem).second)
      continue;
    const auto found = isolated_text([&] { return answers_differently(catalog, *request, store); },
                                     text_seconds_of(problem, kForeignSeconds));
    if (found.is_interrupted)
      store.remark(
          fmt::format("the check of the stored calls of {}: {}", problem.spec, found.failure));
    if (found.is_interrupted || asked_to_end() != Asked::nothing) return false;
    if (found.text && !found.text->empty()) set_evaluations_aside(store, key);
  }
  return true;
}

// Whether any of its repetitions is still to be done, as runs decide it.
bool will_run(const Request& request, Store& store, const RunOptions& options) {
  const std::optional<Record> done = store.find(request);
  return !done || options.redoes(done) || std::ssize(done->repeat_wall_seconds) < options.repeat;
}

// UsageError with the first violated property of a problem of another program, and the measured
// value, or with the reason if a problem cannot be checked, since it fails or does not answer. With
// --uncertified, none is checked, and the labels of those without a certificate say so in each
// table. Checks only problems with cells to run, each at the first of its seeds, in its own
// process, and once for each build. Returns the builds that have passed, by problem; nothing where
// a check was interrupted, which says nothing about the problem.
std::optional<Certificates> require_certified(const Catalog& catalog,
                                              std::vector<Request>& requests, Store& store,
                                              const RunOptions& options) {
  constexpr double kCertificateSeconds = 120;
  std::set<std::string> confirmed;
  if (!confirm_records(catalog, requests, store, options, confirmed)) return std::nullopt;
  Certificates passed;
  std::set<std::string> seen;
  std::vector<const Request*> firsts, to_run;
  for (const Request& request : requests) {
    const std::string& spec = request.problem.spec;
    if (!request.problem.foreign || !will_run(request, store, options)) continue;
    to_run.push_back(&request);
    const bool is_new = !passed.contains(spec);
    if (is_new) passed[spec] = certified_in(store, request.problem);
    if (passed[spec] != build_of(request.problem) && seen.insert(spec).second)
      firsts.push_back(&request);
  }
  if (!confirm_evaluations(catalog, to_run, store, options, std::move(confirmed)))
    return std::nullopt;
  std::set<std::string> uncertified;
  if (options.uncertified)
    for (const Request* request : std::exchange(firsts, {})) {
      uncertified.insert(request->problem.spec);
      passed[request->problem.spec].clear();
    }
  Progress progress(options.progress, "certified", static_cast<std::int64_t>(firsts.size()), 0);
  for (const Request* request : firsts) {
    progress.started(request->problem.spec);
    bool is_announced = false;
    const auto [broken, failure, is_interrupted] = isolated_text(
        [&](Trace& trace) { return checked(catalog, *request, store, options, trace); },
        text_seconds_of(request->problem, kCertificateSeconds), Limits{}.memory_bytes,
        [&](const Trace& trace) {
          if (trace.last.work > 0) progress.started(checks_text(trace.last, request->problem.spec));
          const bool has_calls = trace.last.counts[0] > 0;
          progress.show(has_calls && !std::exchange(is_announced, has_calls));
        });
    if (is_interrupted)
      store.remark(fmt::format("the check of {}: {}", request->problem.spec, failure));
    if (is_interrupted || asked_to_end() != Asked::nothing) return std::nullopt;
    const std::string reason = broken.value_or("it cannot be checked: " + failure);
    require(reason.empty(), [&] {
      return fmt::format(
          "{} failed a check and was not run: {}; `isoline check` prints all its checks, and "
          "--uncertified runs it without them",
          request->problem.spec, reason);
    });
    passed[request->problem.spec] = build_of(request->problem);
    progress.finished();
  }
  for (Request& request : requests)
    if (uncertified.contains(request.problem.spec)) {
      std::string& label = request.problem.foreign->label;
      label = (label.empty() ? request.problem.spec : label) + " (uncertified)";
    }
  return passed;
}

}  // namespace

void require_sound(const Catalog& catalog, const std::vector<Request>& requests) {
  constexpr double kSeconds = 60;
  constexpr std::int64_t kNanoseconds = 3'000'000'000;  // for direct problems
  const std::int64_t last = monotonic_nanoseconds() + kNanoseconds;
  const auto first_complaint = [&]() -> std::string {
    std::set<std::string> problems, optimizers;
    for (const Request& request : requests) try {
        const Component &problem = request.problem, &optimizer = request.optimizer;
        if (optimizers.insert(optimizer.spec).second)
          catalog.optimizers.at(optimizer.name).make(optimizer.options, catalog.optimizers);
        // Direct problems take longer to make: those of a large sweep meet this in their cells.
        const bool has_files = problem.options.contains(kStartOption);
        const bool is_quick = monotonic_nanoseconds() < last && !problem.foreign;
        if ((problem.is_learned || has_files || is_quick) && problems.insert(problem.spec).second)
          make_problem(catalog, problem, request.seed);
      } catch (const UsageError& error) {
        const std::string text = error.what(), &name = request.problem.name;
        const bool is_of_optimizer = text.find(request.optimizer.name) != text.npos;
        return is_of_optimizer || text.find(name) != text.npos ? text : name + ": " + text;
      } catch (const std::exception&) {  // its cells end as `failed` and say so
      }
    return "";
  };
  const auto complaint = isolated_text(first_complaint, kSeconds).text;
  if (complaint && !complaint->empty()) throw UsageError(*complaint);
}

void write_used_rates(const Rates& rates, const std::vector<Request>& requests, Store& store) {
  const std::filesystem::path file = store.folder() / "rates.json";
  std::map<std::array<std::string, 3>, Json> rows;  // by problem, optimizer and table
  const auto add = [&](const Json& row) {
    rows[{row.at("problem"), row.at("optimizer"), row.at("file")}] = row;
  };
  if (is_there(file)) try {
      const Json table = read_json(file);
      for (const Json& row : table.at("rows")) add(row);
    } catch (const AccessError&) {
      throw;
    } catch (const std::exception& error) {
      rows.clear();
      store.set_aside(file, reason_of(error));
    }
  std::set<std::string> known;
  for (const Request& request : requests) {
    const Component& problem = request.problem;
    if (request.rates.empty() ||
        !known.insert(problem.spec + request.optimizer.name + request.rates).second)
      continue;
    const std::string& optimizer = request.optimizer.name;
    // "direct" of "direct.json": what a search in that table alone calls it.
    const std::string table = request.rates.substr(0, request.rates.rfind(".json"));
    const auto add_found = [&](const Rates::Row& row) {
      const Json source = parse_json(row.source, row.origin);
      Json found{{"problem", problem.spec},
                 {"optimizer", optimizer},
                 {"options", to_json(row.options)},
                 {"file", row.origin},
                 {"source", source}};
      if (row.is_from_grid && !source.contains("families") && !row.names_all_of(problem))
        found["setting"] = row.setting;
      add(found);
    };
    const Rates::Row* row = rates.find(problem, optimizer, table);
    if (!row) continue;
    add_found(*row);
    if (!parse_json(row->source, row->origin).contains("families")) continue;
    // Beside a value chosen on other families: the trials on this very problem, for comparison.
    const Rates::Row* own = rates.find(problem, optimizer, table + "-tuned");
    if (own && own->problem == options_of(parse_spec(problem.spec))) add_found(*own);
  }
  if (rows.empty()) return;
  Json all = Json::array();
  for (const auto& [pair, row] : rows) all.push_back(row);
  write_text(file, json_text(Json{{"schema", "isoline.rates/1"}, {"rows", all}}) + "\n");
}

std::vector<PlannedCell> planned_cells(const std::vector<Request>& requests) {
  std::vector<PlannedCell> cells;
  for (const Request& request : requests)
    cells.push_back({request.cell, request.problem.spec, request.optimizer.spec, request.seed});
  return cells;
}

Outcome run_plan(const Catalog& catalog, const WholePlan& whole, std::vector<Request> requests,
                 const std::filesystem::path& folder, const RunOptions& options) {
  const std::int64_t begun = monotonic_nanoseconds();
  const InterruptGuard guard;
  Outcome outcome{.planned = static_cast<std::int64_t>(requests.size()), .is_interrupted = true};
  require_sound(catalog, requests);
  Store store(folder);
  const auto certificates = require_certified(catalog, requests, store, options);
  outcome.remarks = store.remarks();
  if (!certificates || asked_to_end() != Asked::nothing) return outcome;
  store.plan(whole.name, whole.cells);
  write_used_rates(whole.rates, requests, store);
  write_sheets(catalog, requests, store, options.progress, *certificates);
  if (asked_to_end() != Asked::nothing) return outcome;
  outcome = run_all(catalog, requests, store, options);
  if (!outcome.missing.empty()) {
    store.make_folders();
    store.plan(whole.name, whole.cells);
  }
  outcome.remarks = store.remarks();
  outcome.seconds = 1e-9 * static_cast<double>(monotonic_nanoseconds() - begun);
  return outcome;
}

Outcome run_plan(const Catalog& catalog, const std::string& name,
                 const std::vector<Request>& requests, const std::filesystem::path& folder,
                 const RunOptions& options, const Rates& rates) {
  return run_plan(catalog, {name, planned_cells(requests), rates}, requests, folder, options);
}

std::string folder_name_of(const std::vector<Request>& requests, const std::string& title) {
  constexpr std::size_t kDigits = 8, kMostNamed = 3;
  // The distinct names in order, "-a-b"; or how many there are, "-17-problems".
  const auto names_of = [&](Component Request::*component, const char* many) {
    std::vector<std::string> names;
    for (const Request& request : requests)
      if (const std::string& name = (request.*component).name;
          std::ranges::find(names, name) == names.end())
        names.push_back(name);
    if (names.size() > kMostNamed) return fmt::format("-{}-{}", names.size(), many);
    std::string text;
    for (const std::string& name : names) text += "-" + name;
    return text;
  };
  std::vector<std::string> cells;
  for (const Request& request : requests) cells.push_back(request.cell);
  std::ranges::sort(cells);  // the order of the words on the command line does not matter
  std::string all;
  for (const std::string& cell : cells) all += cell;
  const std::string names =
      title + names_of(&Request::problem, "problems") + names_of(&Request::optimizer, "optimizers");
  return fmt::format("{}-{}", names.substr(names.starts_with('-') ? 1 : 0),
                     digest(all).substr(0, kDigits));
}

}  // namespace isoline::benchmarks
