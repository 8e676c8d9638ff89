// The run of a whole plan: workers filled, watched, collected and stored.
#include "benchmarks/run/runner.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "benchmarks/run/execute.h"
#include "benchmarks/run/interrupt_guard.h"
#include "benchmarks/run/prediction.h"
#include "core/records/provenance.h"

namespace isoline::benchmarks {
namespace {

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
        tasks_(workers_.size()),
        predictions_(catalog, store.folder()) {}

  Outcome run(const std::vector<Request>& requests) {
    const InterruptGuard guard;
    const std::vector<const Request*> pending = find_pending(requests);
    outcome_.planned = static_cast<std::int64_t>(requests.size());
    const auto repetitions = static_cast<std::int64_t>(pending.size());
    Progress progress(options_.progress, "cells", outcome_.reused + repetitions, outcome_.reused);
    std::size_t next = 0;
    while (guard.asked() == Asked::nothing) {
      next = start_some(pending, next, progress);
      if (next == pending.size() && idle()) break;
      wait();
      collect(progress);
      progress.show();
    }
    if (guard.asked() != Asked::nothing) stop();
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
      if (options_.force) done.reset();
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

  bool is_reused(const Request& request, const RecordsOfAnyBuild& earlier) {
    if (store_.find(request)) return false;  // by this build
    const std::optional<Record> done = earlier.find(request);
    if (!done) return false;
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
          limits_of(request, options_.limits, predictions_.of(request)), request.threads);
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
      keep(tasks_[i], workers_[i]);
      progress.finished();
    }
  }

  void stop() {
    outcome_.is_interrupted = true;
    for (Worker& worker : workers_) worker.ask_to_stop();
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      if (!workers_[i].is_running()) continue;
      workers_[i].interrupt();
      keep(tasks_[i], workers_[i]);
    }
  }

  void keep(Task& task, const Worker& worker) {
    Record record = record_of(*task.request, worker.trace());
    record.provenance.run = task.run;
    if (options_.keeps_output) record.output = worker.output().text();
    if (record.status == Status::crashed && record.output.empty())
      record.output = worker.output().last_words();
    std::optional<Record> earlier = store_.find(record.request);
    if (options_.force && !repeated(record)) earlier.reset();
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

  static bool same_result(const Record& a, const Record& b) {
    Json left = without_timings(to_json(a)), right = without_timings(to_json(b));
    left.erase("provenance");
    right.erase("provenance");
    return left == right;
  }

  void count(const Record& record) {
    ++outcome_.statuses[record.status];
    if (is_failure(record.status))
      outcome_.failures.push_back(fmt::format("{}: {}: {}", title_of(record.request),
                                              name_of(record.status), record.message));
    if (record.status == Status::interrupted) ++outcome_.interrupted;
  }

  const Catalog& catalog_;
  Store& store_;
  const RunOptions& options_;
  int jobs_;
  std::vector<Worker> workers_;
  std::vector<Task> tasks_;
  Predictions predictions_;
  std::set<std::string> seen_;
  Outcome outcome_;
};

}  // namespace

int one_a_core() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

Outcome run_all(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                const RunOptions& options) {
  return Runner(catalog, store, options).run(requests);
}

}  // namespace isoline::benchmarks
