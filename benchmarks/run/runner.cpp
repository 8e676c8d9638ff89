// The run of a whole plan: workers filled, watched, collected and stored.
#include "benchmarks/run/runner.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include "benchmarks/run/execute.h"
#include "benchmarks/run/same_result.h"
#include "core/records/provenance.h"

namespace isoline::benchmarks {
namespace {

volatile std::sig_atomic_t interrupt_requested = 0;

// While it lives, Ctrl-C and a polite kill only raise a flag; a second one ends us at once.
class InterruptGuard {
 public:
  InterruptGuard() {
    interrupt_requested = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { interrupt_requested = 1; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
  }
  ~InterruptGuard() {
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
  }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  struct sigaction old_int_ {
  }, old_term_{};
};

std::string title_of(const Request& request) {
  return fmt::format("{} × {}, seed {}", request.problem.spec, request.optimizer.spec,
                     request.seed);
}

class Runner {
 public:
  Runner(const Catalog& catalog, Store& store, const RunOptions& options)
      : catalog_(catalog),
        store_(store),
        options_(options),
        jobs_(options.exclusive ? 1 : options.jobs),
        workers_(static_cast<std::size_t>(jobs_)),
        tasks_(workers_.size()) {}

  Outcome run(const std::vector<Request>& requests) {
    const InterruptGuard guard;
    const std::vector<const Request*> pending = find_pending(requests);
    outcome_.planned = static_cast<std::int64_t>(requests.size());
    const auto repetitions = static_cast<std::int64_t>(pending.size());
    Progress progress(options_.progress, "cells", outcome_.reused + repetitions, outcome_.reused);
    std::size_t next = 0;
    while (!interrupt_requested) {
      next = start_some(pending, next, progress);
      if (next == pending.size() && idle()) break;
      wait();
      collect(progress);
      progress.show();
    }
    if (interrupt_requested) stop();
    progress.show(outcome_.run > 0);
    return outcome_;
  }

 private:
  struct Task {
    const Request* request;
    RunProvenance run;
  };

  // One entry a run that is wanted: a cell that is to be timed anew stands in it as often.
  std::vector<const Request*> find_pending(const std::vector<Request>& requests) {
    std::vector<std::pair<std::size_t, const Request*>> rounds;
    std::optional<RecordsOfAnyBuild> earlier;  // times of two builds make no list
    if (options_.reuse && !options_.force && options_.repeat == 1) earlier.emplace(store_.folder());
    for (const Request& request : requests) {
      if (earlier && is_reused(request, *earlier)) continue;
      std::optional<Record> done = store_.find(request);
      if (is_repeated_anyway(done)) done.reset();
      const std::size_t have = done ? done->repeat_wall_seconds.size() : 0;
      const bool is_timed = !done || done->status != Status::inapplicable;
      const auto wanted = static_cast<std::size_t>(is_timed ? options_.repeat : 1);
      if (done && (have >= wanted || is_failure(done->status))) {
        ++outcome_.reused;
        count(*done);
        continue;
      }
      for (std::size_t i = have; i < wanted; ++i) rounds.emplace_back(i - have, &request);
    }
    // Repetitions go round all cells, so that those of one cell see how the machine drifts.
    std::ranges::stable_sort(rounds, {}, [](const auto& entry) { return entry.first; });
    std::vector<const Request*> pending;
    for (const auto& [round, request] : rounds) pending.push_back(request);
    return pending;
  }

  // Whether the record that is there stands in nobody's way.
  bool is_repeated_anyway(const std::optional<Record>& done) const {
    return options_.force || (done && options_.retry.contains(done->status));
  }

  bool is_reused(const Request& request, const RecordsOfAnyBuild& earlier) {
    if (store_.find(request)) return false;  // by this build
    const std::optional<Record> done = earlier.find(request);
    if (!done || is_repeated_anyway(done)) return false;
    ++outcome_.reused;
    ++outcome_.reused_from_other_builds;
    count(*done);
    return true;
  }

  std::size_t start_some(const std::vector<const Request*>& pending, std::size_t next,
                         Progress& progress) {
    for (std::size_t i = 0; i < workers_.size() && next < pending.size(); ++i) {
      if (workers_[i].is_running()) continue;
      const Request& request = *pending[next++];
      tasks_[i] = {&request, run_provenance()};
      progress.started(title_of(request));
      if (options_.force) store_.remove_checkpoint(request);
      workers_[i].start(
          [&](Trace& trace) {
            execute(catalog_, request, trace, checkpoint_of(request), nullptr,
                    options_.perturbation);
          },
          limits_of(request, options_.limits), request.threads);
    }
    return next;
  }

  Checkpoint checkpoint_of(const Request& request) const {
    const auto path = store_.checkpoint_path(request);
    return {path, path.stem().string(), options_.checkpoint_seconds};
  }

  RunProvenance run_provenance() const {
    const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    return {.started = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now)),
            .concurrent_jobs = jobs_,
            .is_exclusive = options_.exclusive,
            .command = options_.command};
  }

  bool idle() const {
    return std::ranges::none_of(workers_, [](const Worker& worker) { return worker.is_running(); });
  }

  void wait() const {
    constexpr int kMilliseconds = 20;  // how often limits are looked at
    std::vector<pollfd> waiting;
    for (const Worker& worker : workers_)
      if (worker.is_running()) waiting.push_back({worker.descriptor(), POLLIN, 0});
    ::poll(waiting.data(), waiting.size(), kMilliseconds);
  }

  void collect(Progress& progress) {
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      if (!workers_[i].is_running() || !workers_[i].poll()) continue;
      keep(tasks_[i], workers_[i].trace());
      progress.finished();
    }
  }

  void stop() {
    outcome_.is_interrupted = true;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      if (!workers_[i].is_running()) continue;
      workers_[i].interrupt();
      keep(tasks_[i], workers_[i].trace());
    }
  }

  void keep(Task& task, const Trace& trace) {
    Record record = record_of(*task.request, trace);
    record.provenance.run = task.run;
    std::optional<Record> earlier = store_.find(record.request);
    if (is_repeated_anyway(earlier) && !repeated(record)) earlier.reset();
    if (earlier && !record.is_nondeterministic && !earlier->is_nondeterministic &&
        !same_result(*earlier, record))
      outcome_.conflicts.push_back(title_of(*task.request));
    store_.write(record, earlier);
    if (record.status != Status::interrupted) store_.remove_checkpoint(record.request);
    ++outcome_.run;
    if (!earlier) count(record);
  }

  // Whether an earlier repetition of this cell ran within this very call.
  bool repeated(const Record& record) { return !seen_.insert(record.cell).second; }

  void count(const Record& record) {
    ++outcome_.statuses[record.status];
    if (is_failure(record.status))
      outcome_.failures.push_back(fmt::format("{}: {}: {}", title_of(record.request),
                                              name_of(record.status), record.message));
  }

  const Catalog& catalog_;
  Store& store_;
  const RunOptions& options_;
  int jobs_;
  std::vector<Worker> workers_;
  std::vector<Task> tasks_;
  std::set<std::string> seen_;
  Outcome outcome_;
};

}  // namespace

int one_a_core() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

Limits limits_of(const Request& request, const Limits& standard) {
  Limits limits = standard;
  if (request.hard_seconds > 0) limits.hard_seconds = request.hard_seconds;
  if (std::isfinite(request.budget.seconds)) limits.hard_seconds = 2 * request.budget.seconds;
  return limits;
}

Outcome run_all(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                const RunOptions& options) {
  return Runner(catalog, store, options).run(requests);
}

}  // namespace isoline::benchmarks
