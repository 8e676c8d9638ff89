// Runs a whole plan: starts workers, watches them, and collects and stores their results.
#include "benchmarks/run/runner.h"

#include <fmt/format.h>
#include <malloc.h>
#include <poll.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <thread>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/judge.h"
#include "benchmarks/run/preview.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/foreign/handshake.h"
#include "core/records/provenance.h"
#include "core/seeds.h"
#include "core/text.h"
#include "core/threads.h"

namespace isoline::benchmarks {

void Outcome::count(const Record& record) {
  ++statuses[record.status];
  if (is_failure(record.status))
    failures.push_back(fmt::format("{}: {}: {}", title_of(record.request), name_of(record.status),
                                   record.message));
  if (record.status == Status::crashed && !crash)
    crash = Crash{record.request, "runs/" + record.file_name()};
  if (record.status == Status::interrupted) ++interrupted;
}

void require_trust(bool is_given, const Record& record) {
  if (is_given) return;
  for (const Component* part : {&record.request.problem, &record.request.optimizer})
    for (const NamedOption& option : part->options)
      require(option.name != "command" &&
                  option_text(option.value).find("command") == std::string::npos,
              [&] {
                return fmt::format(
                    "{} contains a command, which would start a program: {}; if you trust the "
                    "records, add --trust",
                    title_of(record.request), part->spec);
              });
}

std::string title_of(const Request& request) {
  return fmt::format("{} × {}, seed {}", request.problem.spec, request.optimizer.spec,
                     seed_text(request.seed));
}

bool RunOptions::redoes(const std::optional<Record>& done) const {
  const bool lacks_spectrum = keeps_spectra && done && !done->spectrum &&
                              !is_failure(done->status) && done->status != Status::inapplicable;
  return force || lacks_spectrum || (done && retry.contains(done->status));
}

namespace {

// A call that failed once may succeed when it is repeated.
bool ends_at_a_failure(const Trace& trace) {
  return trace.failures.total > 0 && std::isnan(trace.last.loss);
}

// The remaining runs of a plan. Each is given to one process of those that share the folder.
class Pending {
 public:
  // Counts the cells that are already done.
  Pending(const std::vector<Request>& requests, Store& store, const RunOptions& options,
          Outcome& outcome)
      : store_(store), options_(options), outcome_(outcome), holds_(store.folder()) {
    std::vector<std::pair<std::size_t, const Request*>> rounds;
    std::optional<RecordsOfAnyBuild> earlier;  // times of two builds are not comparable
    if (options.reuse && !options.force && options.repeat == 1) earlier.emplace(store.folder());
    for (const Request& request : requests) {
      if (earlier && is_reused(request, *earlier)) continue;
      const std::size_t wanted = runs_wanted(request);
      for (std::size_t i = 0; i < wanted; ++i) rounds.emplace_back(i, &request);
    }
    // Repetitions alternate between all cells, so that a drift of the machine affects the
    // repetitions of each cell.
    std::ranges::stable_sort(rounds, {}, [](const auto& entry) { return entry.first; });
    for (const auto& [round, request] : rounds) queue_.push_back(request);
  }

  // The next run, locked against other processes until it is released. Nothing if all runs are
  // given out, or if other processes run the remaining ones, which may come back.
  const Request* next() {
    constexpr std::int64_t kPatience =
        200'000'000;  // nanoseconds between checks of other processes' cells
    if (monotonic_nanoseconds() < look_again_) return nullptr;
    for (std::size_t left = queue_.size(); left > 0; --left) {
      const Request& request = *queue_.front();
      queue_.pop_front();
      if (!holds_.take(Store::name_of(request))) {
        queue_.push_back(&request);
        continue;
      }
      if (options_.force || runs_wanted(request) > 0) return &request;
      release(request);  // another process has done it in the meantime
    }
    if (!queue_.empty()) look_again_ = monotonic_nanoseconds() + kPatience;
    return nullptr;
  }
  void release(const Request& request) { holds_.release(Store::name_of(request)); }
  const std::deque<const Request*>& queued() const { return queue_; }

 private:
  // The number of remaining repetitions of a cell. A cell that is done is counted.
  std::size_t runs_wanted(const Request& request) {
    std::optional<Record> done = store_.find(request);
    if (options_.redoes(done)) done.reset();
    const std::size_t have = done ? done->repeat_wall_seconds.size() : 0;
    const bool is_timed = !done || done->status != Status::inapplicable;
    const auto wanted = static_cast<std::size_t>(is_timed ? options_.repeat : 1);
    if (!done || (have < wanted && !is_failure(done->status))) return wanted - have;
    ++outcome_.reused;
    outcome_.count(*done);
    return 0;
  }

  bool is_reused(const Request& request, const RecordsOfAnyBuild& earlier) {
    if (store_.find(request)) return false;  // by this build
    const std::optional<Record> done = earlier.find(request);
    if (!done || options_.redoes(done)) return false;
    ++outcome_.reused_from_other_builds;
    ++outcome_.reused;
    outcome_.count(*done);
    return true;
  }

  Store& store_;
  const RunOptions& options_;
  Outcome& outcome_;
  Holds holds_;
  std::deque<const Request*> queue_;  // a cell is queued once for each of its timings
  std::int64_t look_again_ = 0;       // monotonic nanoseconds
};

class Runner {
 public:
  Runner(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
         const RunOptions& options)
      : catalog_(catalog),
        store_(store),
        options_(options),
        jobs_(options.exclusive ? 1 : options.jobs),
        workers_(static_cast<std::size_t>(options.exclusive ? 1 : jobs_ + 1)),
        tasks_(workers_.size()),
        judges_(catalog, workers_),
        declared_(catalog, store.folder()),
        pending_(requests, store, options, outcome_),
        progress_(options.progress, "cells",
                  outcome_.reused + static_cast<std::int64_t>(pending_.queued().size()),
                  outcome_.reused) {
    outcome_.planned = static_cast<std::int64_t>(requests.size());
  }

  Outcome run() {
    seconds_per_tick();  // measured once here, or each cell would take a millisecond for it
    if (options_.progress != Progress::Style::silent && !pending_.queued().empty())
      earlier_ = EarlierTimes(record_outlines({store_.folder()}));
    for (const Request* request : pending_.queued()) progress_.expect(earlier_.of(*request));
    malloc_trim(0);  // return the memory that planning used: a fork copies the tables of all pages
    while (asked_to_end() != Asked::stop) {
      if (asked_to_end() == Asked::nothing) start_some();
      keep_judged();
      const bool is_over = asked_to_end() == Asked::finish || pending_.queued().empty();
      if (is_over && running() == 0) break;
      if (asked_to_end() == Asked::finish) say_once_that_it_finishes();
      wait();
      collect();
      progress_.show();
    }
    keep_judged();
    if (running() > 0) stop();
    outcome_.is_interrupted |= !pending_.queued().empty();
    progress_.show(outcome_.run > 0);
    return outcome_;
  }

 private:
  struct Task {
    const Request* request = nullptr;  // nothing is done here
    RunProvenance run = {};
    bool is_being_judged = false;  // the cell itself has ended
  };

  std::ptrdiff_t running() const {
    return std::ranges::count_if(tasks_, [](const Task& task) { return task.request; });
  }

  // There is one more worker than the number of running cells, so that the result of one is judged
  // and stored while the others run.
  void start_some() {
    constexpr double kCheckpointSeconds = 120;  // interval between checkpoints of a long run
    auto running = std::ranges::count_if(workers_, &Worker::is_running);
    for (std::size_t i = 0; i < workers_.size() && running < jobs_; ++i) {
      if (tasks_[i].request) continue;
      const Request* request = pending_.next();
      if (!request) return;
      ++running;
      tasks_[i] = {request,
                   {.started = instant_text(seconds_now()),
                    .concurrent_jobs = jobs_,
                    .is_exclusive = options_.exclusive,
                    .command = options_.command}};
      progress_.started(title_of(*request));
      if (options_.force) store_.remove_checkpoint(*request);
      const EndStates ends = end_states(*request);
      outcome_.continued += !ends.from.empty();
      workers_[i].start(
          [&, i, request](Trace& trace) {
            trace.spectra.are_wanted = options_.keeps_spectra;
            const auto path = store_.checkpoint_path(*request);
            Checkpoint checkpoint(path, path.stem().string(), kCheckpointSeconds);
            checkpoint.continue_from(ends);
            if (logs_calls_of(*request)) checkpoint.log_calls(options_.logs_calls);
            Vector returned;
            execute(catalog_, *request, trace, std::move(checkpoint), &returned,
                    options_.perturbation);
            workers_[i].keep_returned({returned.data(), static_cast<std::size_t>(returned.size())});
          },
          limits(*request), request->threads);
    }
  }

  // A run whose time counts makes its calls.
  bool logs_calls_of(const Request& request) const {
    return is_elsewhere(request.problem) && options_.repeat == 1 && !options_.exclusive &&
           options_.perturbation == 0;
  }
  std::filesystem::path calls_path(const Request& request) const {
    if (!logs_calls_of(request)) return {};
    return store_.checkpoint_path(request).replace_extension(".calls");
  }

  // A repetition for its time begins at the start, as does a run that records more than others.
  EndStates end_states(const Request& request) const {
    if (options_.keeps_spectra || options_.perturbation != 0) return {};
    EndStates ends{
        .stem = store_.end_stem(request), .from = {}, .least_seconds = options_.least_kept_seconds};
    if (!options_.force && !options_.exclusive && options_.repeat == 1 && !store_.has(request))
      ends.from = store_.end_within_budget(request);
    return ends;
  }

  Limits limits(const Request& request) {
    return limits_of(request, options_.limits, declared_.of(request));
  }

  void say_once_that_it_finishes() {
    if (std::exchange(has_said_, true) || options_.progress == Progress::Style::silent) return;
    say(stderr, fmt::format("\nfinishing {} running; Ctrl-C again stops now\n",
                            running() == 1 ? "the cell that is"
                                           : fmt::format("{} cells that are", running())));
  }

  void wait() const {
    std::vector<pollfd> waiting;
    for (const Worker& worker : workers_)
      if (worker.is_running()) waiting.push_back({worker.descriptor(), POLLIN, 0});
    judges_.add_to(waiting);
    ::poll(waiting.data(), waiting.size(), kLookMilliseconds);
  }

  // If a cell returns a point, a verifier evaluates it before the record is stored.
  void collect() {
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      Task& task = tasks_[i];
      if (!task.request || task.is_being_judged || !workers_[i].poll()) continue;
      const Status status = workers_[i].trace().status;
      task.is_being_judged =
          !is_failure(status) && status != Status::inapplicable && status != Status::interrupted;
      if (task.is_being_judged)
        judges_.ask(i, *task.request, limits(*task.request), calls_path(*task.request));
      else
        keep(i);
    }
  }

  void keep_judged() {
    for (const Verdict& verdict : judges_.collect()) {
      Worker& worker = workers_[verdict.slot];
      if (!verdict.judged)
        worker.conclude(verdict.is_interrupted ? Status::interrupted : Status::failed,
                        "the returned point could not be verified: " + verdict.failure);
      else if (const auto found = contradiction(told_by(worker.trace()), *verdict.judged);
               !found.empty() && !ends_at_a_failure(worker.trace()))
        worker.conclude(Status::failed, found);
      keep(verdict.slot);
    }
  }

  // Running cells save their state and end. If a point has not been verified by then, its cell runs
  // again.
  void stop() {
    constexpr std::int64_t kGrace = 3'000'000'000;  // nanoseconds
    outcome_.is_interrupted = true;
    for (Worker& worker : workers_) worker.ask_to_stop();
    for (Worker& worker : workers_)
      if (worker.is_running()) worker.interrupt();
    const std::int64_t last = monotonic_nanoseconds() + kGrace;
    for (collect(); running() > 0 && monotonic_nanoseconds() < last; keep_judged()) wait();
  }

  void keep(std::size_t slot) {
    const Request& request = *tasks_[slot].request;
    Worker& worker = workers_[slot];
    try {
      require_unedited(request.problem.foreign);
      require_unedited(request.optimizer.foreign);
    } catch (const KilledProgram& edited) {
      worker.conclude(Status::interrupted, edited.what());
    }
    Record record = record_of(request, worker.trace());
    record.provenance.run = tasks_[slot].run;
    if (request.seed > 0 && !options_.keeps_fields) record.fields.reset();
    if (options_.keeps_output) record.output = worker.output().text();
    if (record.status == Status::crashed && record.output.empty())
      record.output = worker.output().last_words();
    std::optional<Record> earlier = store_.find(request);
    const bool is_repeated = !seen_.insert(record.cell).second;  // within this very call
    if (options_.redoes(earlier) && !is_repeated) earlier.reset();
    if (earlier && !record.is_nondeterministic && !earlier->is_nondeterministic &&
        !same_result(*earlier, record))
      outcome_.conflicts.push_back(title_of(request));
    if (earlier && !record.fields) record.fields = earlier->fields;  // its file is there
    if (earlier && !record.spectrum) record.spectrum = earlier->spectrum;
    store_.write(record, earlier);
    if (record.status != Status::interrupted) store_.remove_checkpoint(request);
    ++outcome_.run;
    if (!earlier) outcome_.count(record);
    pending_.release(request);
    tasks_[slot] = {};
    progress_.finished(earlier_.of(request));
  }

  const Catalog& catalog_;
  Store& store_;
  const RunOptions& options_;
  Outcome outcome_;
  int jobs_;
  std::vector<Worker> workers_;
  std::vector<Task> tasks_;
  Judges judges_;
  DeclaredTimes declared_;  // for their limits
  Pending pending_;
  Progress progress_;
  EarlierTimes earlier_;
  std::set<std::string> seen_;
  bool has_said_ = false;  // that it is finishing
};

}  // namespace

int one_a_core() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

Outcome run_all(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                const RunOptions& options) {
  const InterruptGuard guard;
  end_what_killed_runs_left();
  Outcome outcome = Runner(catalog, requests, store, options).run();
  if (outcome.is_interrupted) return outcome;
  std::optional<RecordsOfAnyBuild> earlier;
  if (options.reuse) earlier.emplace(store.folder());
  for (const Request& request : requests)
    if (!store.has(request) && !(earlier && earlier->find(request)))
      outcome.missing.push_back(title_of(request));
  return outcome;
}

void run_in_process(const Catalog& catalog, const std::vector<Request>& requests,
                    const std::function<void(const Request&, const Trace&)>& ended) {
  for (const Request& request : requests) {
    set_library_threads(request.threads);
    const auto trace = std::make_unique<Trace>();  // too large for a stack
    execute(catalog, request, *trace);
    ended(request, *trace);
  }
}

Request request_again(const Catalog& catalog, const Record& record, double hard_seconds) {
  Request request = record.request;
  const Component &problem = record.request.problem, &optimizer = record.request.optimizer;
  request.problem = complete_problem(catalog, problem.name, problem.options);
  request.optimizer = complete_optimizer(catalog, optimizer.name, optimizer.options);
  request.problem.asked = problem.asked;
  request.optimizer.asked = optimizer.asked;
  request.hard_seconds = hard_seconds;
  if (request.problem.foreign && record.foreign.problem)  // it may say "(uncertified)"
    request.problem.foreign->label = record.foreign.problem->label;
  return named(std::move(request));
}

std::optional<std::vector<Record>> perturbed_records(const Catalog& catalog,
                                                     const std::vector<Record>& records, int number,
                                                     RunOptions options) {
  constexpr double kLongest = 600;  // seconds: the record has ended without a clock before
  std::vector<Request> requests;
  for (const Record& record : records) {
    if (record.is_nondeterministic || record.status == Status::inapplicable) continue;
    const Request& request = requests.emplace_back(request_again(catalog, record, kLongest));
    require(request.cell == record.cell && build_digest(request) == record.build, [&] {
      return title_of(request) +
             ": its record is of another build; run the cell again with this build (isoline run), "
             "or keep its record without perturbations (--perturbations 0)";
    });
  }
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
