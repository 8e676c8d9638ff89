// The run of a whole plan, and the same runs from perturbed starts.
#include "benchmarks/run/runner.h"

#include <fmt/format.h>
#include <malloc.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/interrupts.h"
#include "benchmarks/run/judge.h"
#include "benchmarks/run/pending.h"
#include "benchmarks/run/prediction.h"
#include "benchmarks/run/process_group.h"
#include "benchmarks/run/same_result.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/provenance.h"
#include "core/status.h"
#include "core/text.h"
#include "core/threads.h"

namespace isoline::benchmarks {

void Outcome::count(const Record& record) {
  ++statuses[record.status];
  if (is_failure(record.status))
    failures.push_back(fmt::format("{}: {}: {}", title_of(record.request), name_of(record.status),
                                   record.message));
  if (record.status == Status::crashed && !crash)
    crash = Crash{record.request, fmt::format("runs/{}-{}.json", record.cell, record.build)};
  if (record.status == Status::interrupted) ++interrupted;
}

std::string title_of(const Request& request) {
  return fmt::format("{} × {}, seed {}", request.problem.spec, request.optimizer.spec,
                     request.seed);
}

// The run of a whole plan: workers filled, watched, collected and stored.

namespace {

class Runner {
 public:
  Runner(const Catalog& catalog, Store& store, const RunOptions& options)
      : catalog_(catalog),
        store_(store),
        options_(options),
        jobs_(options.exclusive ? 1 : options.jobs),
        workers_(static_cast<std::size_t>(options_.exclusive ? 1 : jobs_ + 1)),
        tasks_(workers_.size()),
        judges_(catalog, workers_),
        declared_(catalog, store.folder()) {}

  Outcome run(const std::vector<Request>& requests) {
    const InterruptGuard guard;
    seconds_per_tick();  // measured once here, or each cell would take a millisecond for it
    outcome_.planned = static_cast<std::int64_t>(requests.size());
    Pending pending(requests, store_, options_, outcome_);
    pending_ = &pending;
    Progress progress(options_.progress, "cells",
                      outcome_.reused + static_cast<std::int64_t>(pending.size()), outcome_.reused);
    if (options_.progress != Progress::Style::silent && !pending.is_empty())
      earlier_ = EarlierTimes(record_outlines({store_.folder()}));
    for (const Request* request : pending.queued()) progress.expect(earlier_.of(*request));
    malloc_trim(0);  // what planning freed: a fork copies the tables of all pages that are held
    while (asked_to_end() != Asked::stop) {
      if (asked_to_end() == Asked::nothing) start_some(progress);
      keep_judged(progress);
      const bool is_over = asked_to_end() == Asked::finish || pending.is_empty();
      if (is_over && is_idle()) break;
      tell_once(asked_to_end());
      wait();
      collect(progress);
      progress.show();
    }
    keep_judged(progress);
    if (!is_idle()) stop();
    outcome_.is_interrupted |= !pending.is_empty();
    progress.show(outcome_.run > 0);
    return outcome_;
  }

 private:
  struct Task {
    const Request* request = nullptr;  // nothing is done here
    RunProvenance run = {};
    bool is_being_judged = false;  // the cell itself has ended
  };

  // There is one worker more than may run: what it did is judged and stored while the others run.
  void start_some(Progress& progress) {
    auto running = std::ranges::count_if(workers_, &Worker::is_running);
    for (std::size_t i = 0; i < workers_.size() && running < jobs_; ++i) {
      if (tasks_[i].request) continue;
      const Request* request = pending_->next();
      if (!request) return;
      ++running;
      tasks_[i] = {request, run_provenance()};
      progress.started(title_of(*request));
      if (options_.force) store_.remove_checkpoint(*request);
      workers_[i].start(
          [&, i, request](Trace& trace) {
            trace.spectra.are_wanted = options_.keeps_spectra;
            Vector returned;
            execute(catalog_, *request, trace, checkpoint_of(*request), &returned,
                    options_.perturbation);
            workers_[i].keep_returned({returned.data(), static_cast<std::size_t>(returned.size())});
          },
          limits(*request), request->threads);
    }
  }

  Limits limits(const Request& request) {
    return limits_of(request, options_.limits, declared_.of(request));
  }

  void tell_once(Asked asked) {
    if (asked != Asked::finish || std::exchange(has_told_, true) ||
        options_.progress == Progress::Style::silent)
      return;
    const auto running =
        std::ranges::count_if(tasks_, [](const Task& task) { return task.request; });
    say(stderr,
        fmt::format("\nfinishing {} running; Ctrl-C again stops now\n",
                    running == 1 ? "the cell that is" : fmt::format("{} cells that are", running)));
  }

  Checkpoint checkpoint_of(const Request& request) const {
    const auto path = store_.checkpoint_path(request);
    return {path, path.stem().string(), options_.checkpoint_seconds};
  }

  RunProvenance run_provenance() const {
    return {.started = instant_text(seconds_now()),
            .concurrent_jobs = jobs_,
            .is_exclusive = options_.exclusive,
            .command = options_.command};
  }

  bool is_idle() const {
    return std::ranges::none_of(tasks_, [](const Task& task) { return task.request; });
  }

  void wait() const {
    constexpr int kMilliseconds = 20;  // how often limits are looked at
    std::vector<pollfd> waiting;
    for (const Worker& worker : workers_)
      if (worker.is_running()) waiting.push_back({worker.descriptor(), POLLIN, 0});
    judges_.add_to(waiting);
    ::poll(waiting.data(), waiting.size(), kMilliseconds);
  }

  // Cells that have ended go to a judge where they claim a point, and are kept once it has spoken.
  void collect(Progress& progress) {
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      Task& task = tasks_[i];
      if (!task.request || task.is_being_judged || !workers_[i].poll()) continue;
      task.is_being_judged = has_point(workers_[i].trace());
      if (task.is_being_judged)
        judges_.ask(i, *task.request, limits(*task.request));
      else
        keep(i, progress);
    }
  }

  void keep_judged(Progress& progress) {
    for (const Verdict& verdict : judges_.collect()) {
      settle(verdict);
      keep(verdict.slot, progress);
    }
  }

  static bool has_point(const Trace& trace) {
    return !is_failure(trace.status) && trace.status != Status::inapplicable &&
           trace.status != Status::interrupted;
  }

  void settle(const Verdict& verdict) {
    Worker& worker = workers_[verdict.slot];
    if (!verdict.judged)
      return worker.dispute(verdict.is_interrupted ? Status::interrupted : Status::failed,
                            "its point could not be verified: " + verdict.failure);
    const std::string found = contradiction(told_by(worker.trace()), *verdict.judged);
    if (!found.empty()) worker.dispute(Status::failed, found);
  }

  // Cells that run keep their state and end; a point that no judge has seen by then is found again.
  void stop() {
    constexpr std::int64_t kGrace = 3'000'000'000;  // nanoseconds
    outcome_.is_interrupted = true;
    for (Worker& worker : workers_) worker.ask_to_stop();
    for (Worker& worker : workers_)
      if (worker.is_running()) worker.interrupt();
    Progress silent(Progress::Style::silent, "", 0, 0);
    const std::int64_t last = monotonic_nanoseconds() + kGrace;
    for (collect(silent); !is_idle() && monotonic_nanoseconds() < last; keep_judged(silent)) wait();
  }

  void keep(std::size_t slot, Progress& progress) {
    const Request& request = *tasks_[slot].request;
    keep(tasks_[slot], workers_[slot]);
    pending_->release(request);
    tasks_[slot] = {};
    progress.finished(earlier_.of(request));
  }

  void keep(Task& task, const Worker& worker) {
    Record record = record_of(*task.request, worker.trace());
    record.provenance.run = task.run;
    if (task.request->seed > 0 && !options_.keeps_fields) record.fields.reset();
    if (options_.keeps_output) record.output = worker.output().text();
    if (record.status == Status::crashed && record.output.empty())
      record.output = worker.output().last_words();
    std::optional<Record> earlier = store_.find(record.request);
    if (options_.redoes(earlier) && !repeated(record)) earlier.reset();
    if (earlier && !record.is_nondeterministic && !earlier->is_nondeterministic &&
        !same_result(*earlier, record))
      outcome_.conflicts.push_back(title_of(*task.request));
    if (earlier && !record.fields) record.fields = earlier->fields;  // its file is there
    if (earlier && !record.spectrum) record.spectrum = earlier->spectrum;
    store_.write(record, earlier);
    if (record.status != Status::interrupted) store_.remove_checkpoint(record.request);
    ++outcome_.run;
    if (!earlier) outcome_.count(record);
  }

  // Whether an earlier repetition of this cell ran within this very call.
  bool repeated(const Record& record) { return !seen_.insert(record.cell).second; }

  const Catalog& catalog_;
  Store& store_;
  const RunOptions& options_;
  int jobs_;
  std::vector<Worker> workers_;
  std::vector<Task> tasks_;
  Judges judges_;
  Pending* pending_ = nullptr;  // of the plan that is run
  DeclaredTimes declared_;      // for their limits
  EarlierTimes earlier_;
  std::set<std::string> seen_;
  bool has_told_ = false;  // that it is finishing
  Outcome outcome_;
};

}  // namespace

int one_a_core() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

Outcome run_all(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                const RunOptions& options) {
  end_what_killed_runs_left();
  Outcome outcome = Runner(catalog, store, options).run(requests);
  if (outcome.is_interrupted) return outcome;
  const std::optional<RecordsOfAnyBuild> earlier =
      options.reuse ? std::optional<RecordsOfAnyBuild>(store.folder()) : std::nullopt;
  for (const Request& request : requests)
    if (!store.has(request) && !(earlier && earlier->find(request)))
      outcome.missing.push_back(title_of(request));
  return outcome;
}

// The run loop without anything around it.

void run_in_process(const Catalog& catalog, const std::vector<Request>& requests,
                    const std::function<void(const Request&, const Trace&)>& ended) {
  for (const Request& request : requests) {
    set_library_threads(request.threads);
    const auto trace = std::make_unique<Trace>();  // too large for a stack
    execute(catalog, request, *trace);
    ended(request, *trace);
  }
}

// Requests restored from records.

Request request_again(const Catalog& catalog, const Record& record, double hard_seconds) {
  Request request = record.request;
  const Component &problem = record.request.problem, &optimizer = record.request.optimizer;
  request.problem = complete_problem(catalog, problem.name, problem.options);
  request.optimizer = complete_optimizer(catalog, optimizer.name, optimizer.options);
  request.problem.asked = problem.asked;
  request.optimizer.asked = optimizer.asked;
  request.hard_seconds = hard_seconds;
  return named(std::move(request));
}

// Runs the requests of records again, in a hidden folder.

namespace {

// The request of a record, in the options of this program.
Request same_request(const Catalog& catalog, const Record& record) {
  constexpr double kLongest = 600;  // seconds: the record has ended without a clock before
  const Request request = request_again(catalog, record, kLongest);
  require(request.cell == record.cell && build_digest(request) == record.build, [&] {
    return title_of(request) +
           ": its record is of another build; run it by this one (isoline run), or keep "
           "it without perturbations (--perturbations 0)";
  });
  return request;
}

bool is_repeated(const Record& record) {
  return !record.is_nondeterministic && record.status != Status::inapplicable;
}

}  // namespace

std::optional<std::vector<Record>> perturbed_records(const Catalog& catalog,
                                                     const std::vector<Record>& records, int number,
                                                     RunOptions options) {
  std::vector<Request> requests;
  for (const Record& record : records)
    if (is_repeated(record)) requests.push_back(same_request(catalog, record));
  const HiddenFolder folder;
  Store store(folder.path());
  options.perturbation = number;
  if (run_all(catalog, requests, store, options).is_interrupted) return std::nullopt;
  std::vector<Record> perturbed;
  for (const Request& request : requests)
    if (std::optional<Record> record = store.find(request)) perturbed.push_back(std::move(*record));
  return perturbed;
}

}  // namespace isoline::benchmarks
