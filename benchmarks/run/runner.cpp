// Runs a whole plan: starts workers, watches them, and collects and stores their results.
#include "benchmarks/run/runner.h"

#include <fmt/format.h>
#include <malloc.h>
#include <poll.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <ranges>
#include <set>
#include <thread>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/calls.h"
#include "benchmarks/run/execute.h"
#include "benchmarks/run/judge.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/foreign/evaluations.h"
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
  if (record.minimum && !record.request.problem.is_learned &&
      record.summary.start_loss <= *record.minimum)
    solved_at_start.insert(record.request.problem.spec);
}

void Outcome::uncount(const Record& record) {
  if (--statuses[record.status] == 0) statuses.erase(record.status);
  std::erase_if(failures, [title = title_of(record.request) + ": "](const std::string& failure) {
    return failure.starts_with(title);
  });
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

// A run whose time counts makes its calls. One that is to be repeated makes those that failed.
Evaluations::Settings evaluations_of(const RunOptions& options, const Request& request,
                                     const std::filesystem::path& folder) {
  const bool has_store = is_elsewhere(request.problem) && options.repeat == 1 &&
                         !options.exclusive && options.perturbation == 0;
  return {.folder = has_store ? folder : std::filesystem::path(),
          .keeps_all = options.logs_calls,
          .answers = !options.force,
          .answers_failures = options.retry.empty()};
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
    std::map<std::string_view, std::size_t> problems;  // in order
    for (const Request& request : requests)
      problems.try_emplace(request.problem.spec, problems.size());
    // Repetitions alternate between all cells, so that a drift of the machine affects the
    // repetitions of each cell. Cells of one problem follow one another: they share processes.
    std::ranges::stable_sort(rounds, {}, [&](const auto& entry) {
      return std::pair(entry.first, problems.at(entry.second->problem.spec));
    });
    for (const auto& [round, request] : rounds) queue_.push_back(request);
  }

  // The next run, locked against other processes until it is released. Nothing if all runs are
  // given out, if other processes run the remaining ones, which may come back, or if the next one
  // is not wanted.
  const Request* next(const std::function<bool(const Request&)>& is_wanted) {
    constexpr std::int64_t kPatience =
        200'000'000;  // nanoseconds between checks of other processes' cells
    if (monotonic_nanoseconds() < look_again_) return nullptr;
    for (std::size_t left = queue_.size(); left > 0; --left) {
      const Request& request = *queue_.front();
      if (!is_wanted(request)) return nullptr;
      queue_.pop_front();
      if (!holds_.take(Store::name_of(request))) {
        queue_.push_back(&request);
        continue;
      }
      if (options_.force || again_.erase(&request) > 0 || runs_wanted(request) > 0) return &request;
      release(request);  // another process has done it in the meantime
    }
    if (!queue_.empty()) look_again_ = monotonic_nanoseconds() + kPatience;
    return nullptr;
  }
  void release(const Request& request) { holds_.release(Store::name_of(request)); }
  const std::deque<const Request*>& queued() const { return queue_; }
  // Next, whether or not it is done. It is not locked.
  void run_again(const Request& request) {
    queue_.push_front(&request);
    again_.insert(&request);
  }

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
  std::set<const Request*> again_;    // of these, those that run even if they are done
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
        kept_(workers_.size()),
        judges_(catalog, workers_),
        declared_(catalog, store.folder()),
        pending_(requests, store, options, outcome_),
        progress_(options.progress, "cells",
                  outcome_.reused + static_cast<std::int64_t>(pending_.queued().size()),
                  outcome_.reused) {
    outcome_.planned = static_cast<std::int64_t>(requests.size());
    store_.look_for_states();
  }

  Outcome run() {
    seconds_per_tick();  // measured once here, or each cell would take a millisecond for it
    malloc_trim(0);  // return the memory that planning used: a fork copies the tables of all pages
    // From now on memory that is freed stays: each cell would be given new pages otherwise.
    constexpr int kStays = 32 << 20;
    mallopt(M_TRIM_THRESHOLD, kStays);
    mallopt(M_MMAP_THRESHOLD, kStays);
    while (asked_to_end() != Asked::stop) {
      keep_judged();  // first: a worker that is free begins at once
      if (asked_to_end() == Asked::nothing) start_some();
      const bool is_over = asked_to_end() == Asked::finish || pending_.queued().empty();
      if (is_over && running() == 0) break;
      if (asked_to_end() == Asked::finish) say_once_that_it_finishes();
      wait();
      collect();
      if (monotonic_nanoseconds() >= flush_at_) flush();
      say_new_remarks();
      progress_.show();
    }
    keep_judged();
    if (running() > 0) stop();
    flush();
    for (const auto& [request, first] : doubtful_) store_.remove(*request);
    outcome_.is_interrupted |= !pending_.queued().empty();
    progress_.show(outcome_.run > 0);
    return outcome_;
  }

 private:
  struct Task {
    const Request* request = nullptr;  // nothing is done here
    RunProvenance run = {};
    std::int64_t begun = 0;        // monotonic nanoseconds
    bool is_shared = false;        // its process has run others, or may
    bool is_being_judged = false;  // the cell itself has ended
    Verdict verdict = {};
    std::size_t remarks = 0;  // that were said
  };
  // The cells that the process of a worker is kept ready for, and those that it has finished.
  struct Kept {
    std::string problem;
    int threads = 1;
    std::vector<const Request*> finished = {};
  };

  std::ptrdiff_t running() const {
    return std::ranges::count_if(tasks_, [](const Task& task) { return task.request; });
  }

  // A cell has a process of its own where its time counts, where it runs code of others or holds
  // the state of a network, and where its result is in doubt.
  bool shares_process(const Request& request) const {
    return !options_.isolates_cells && !options_.exclusive && options_.repeat == 1 &&
           !request.problem.foreign && !request.optimizer.foreign && !request.problem.is_learned &&
           !doubtful_.contains(&request);
  }

  // There is one more worker than the number of running cells, so that the result of one is judged
  // and stored while the others run; it keeps no process ready.
  void start_some() {
    auto running = std::ranges::count_if(workers_, &Worker::is_running);
    for (std::size_t i = 0; i < workers_.size() && running < jobs_; ++i) {
      if (tasks_[i].request) continue;
      const bool keeps_process = i < static_cast<std::size_t>(jobs_);
      const Request* request = pending_.next(
          [&](const Request& next) { return keeps_process || !shares_process(next); });
      if (!request) return;
      ++running;
      tasks_[i] = {request,
                   {.started = instant_text(seconds_now()),
                    .concurrent_jobs = jobs_,
                    .is_exclusive = options_.exclusive,
                    .command = options_.command},
                   monotonic_nanoseconds()};
      progress_.started(title_of(*request));
      if (options_.force) store_.remove_checkpoint(*request);
      const std::filesystem::path from = end_to_continue(*request);
      outcome_.continued += !from.empty();
      tasks_[i].is_shared = from.empty() && shares_process(*request);
      if (tasks_[i].is_shared)
        hand_over(i, *request);
      else
        workers_[i].start([=, this](Trace& trace) { compute(i, *request, from, trace); },
                          limits(*request), request->threads);
    }
  }

  void hand_over(std::size_t i, const Request& request) {
    constexpr std::size_t kMost = 512;  // cells of one process: after a fault they run again
    Kept& kept = kept_[i];
    if (!workers_[i].is_ready() || kept.problem != request.problem.spec ||
        kept.threads != request.threads || kept.finished.size() >= kMost) {
      kept = {request.problem.spec, request.threads};
      workers_[i].keep_ready(
          [=, this, rehearsed = std::set<std::string>()](const Request& cell,
                                                         Trace& trace) mutable {
            if (rehearsed.insert(cell.optimizer.name).second) rehearse(cell);
            compute(i, cell, {}, trace);
          },
          request.threads);
    }
    workers_[i].hand_over(request, limits(request));
  }

  // Libraries bind their symbols and allocate their buffers in their first call, which no method
  // should be charged for.
  void rehearse(Request cell) const {
    if (!catalog_.problems.contains("rosenbrock")) return;
    cell.problem = complete_problem(catalog_, "rosenbrock", OptionValues());
    cell.budget = {.iterations = 2, .work = 100};
    run_in_process(catalog_, {std::move(cell)}, [](const Request&, const Trace&) {});
  }

  // In the process of a worker.
  void compute(std::size_t i, const Request& request, const std::filesystem::path& from,
               Trace& trace) {
    constexpr double kCheckpointSeconds = 120;  // interval between checkpoints of a long run
    trace.wants_spectra = options_.keeps_spectra;
    const auto path = store_.checkpoint_path(request);
    Checkpoint checkpoint(path, path.stem().string(), kCheckpointSeconds);
    if (keeps_ends())
      checkpoint.continue_from({store_.end_stem(request), from, options_.least_kept_seconds});
    evaluations().begin(evaluations_of(options_, request, store_.folder()));
    Vector returned;
    execute(catalog_, request, trace, std::move(checkpoint), &returned, options_.perturbation);
    workers_[i].keep_returned({returned.data(), static_cast<std::size_t>(returned.size())});
  }

  // The cell of a worker and all that its process has finished run again, each in a fresh process.
  void doubt(std::size_t i, Status fault) {
    flush();
    const std::vector<const Request*> finished = std::exchange(kept_[i].finished, {});
    const Request& request = *std::exchange(tasks_[i], {}).request;
    store_.remark(fmt::format(
        "{}: {} in a process that had finished {} other cell{}; all of them "
        "ran again, each in a fresh process",
        title_of(request), name_of(fault), finished.size(), finished.size() == 1 ? "" : "s"));
    workers_[i].retire();
    store_.remove_checkpoint(request);
    pending_.release(request);
    doubtful_[&request] = fault;
    pending_.run_again(request);
    for (const Request* before : std::views::reverse(finished)) {
      doubtful_[before] = {};
      pending_.run_again(*before);
    }
  }

  // A repetition for its time begins at the start, as does a run that records more than others.
  bool keeps_ends() const { return !options_.keeps_spectra && options_.perturbation == 0; }
  std::filesystem::path end_to_continue(const Request& request) const {
    if (!keeps_ends() || options_.force || options_.exclusive || options_.repeat > 1) return {};
    const std::filesystem::path end = store_.end_within_budget(request);
    return end.empty() || store_.has(request) ? std::filesystem::path() : end;
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
      if (workers_[i].was_fault() && is_after_others(i)) {
        doubt(i, status);
        continue;
      }
      task.is_being_judged =
          !is_failure(status) && status != Status::inapplicable && status != Status::interrupted;
      if (task.is_being_judged)
        judges_.ask(i, *task.request, limits(*task.request),
                    evaluations_of(options_, *task.request, store_.folder()).folder);
      else
        keep(i);
    }
  }

  bool is_after_others(std::size_t i) const {
    return tasks_[i].is_shared && !kept_[i].finished.empty();
  }

  void keep_judged() {
    for (const Verdict& verdict : judges_.collect()) {
      Worker& worker = workers_[verdict.slot];
      tasks_[verdict.slot].verdict = verdict;
      if (!verdict.judged)
        worker.conclude(verdict.is_interrupted ? Status::interrupted : Status::failed,
                        "the returned point could not be verified: " + verdict.failure);
      else if (const auto found = contradiction(told_by(worker.trace()), *verdict.judged);
               !found.empty() && !ends_at_a_failure(worker.trace())) {
        if (is_after_others(verdict.slot)) {  // it may have met what they left behind
          doubt(verdict.slot, Status::failed);
          continue;
        }
        worker.conclude(Status::failed, found);
      }
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

  // Without a call by the verifier that succeeded, it is unknown whether the point was verified.
  void note_calls(std::size_t slot, Record& record) {
    const Task& task = tasks_[slot];
    if (!is_elsewhere(task.request->problem)) return;
    for (const std::string& remark : remarks_in(workers_[slot].output().text()))
      store_.remark(fmt::format("{}: {}", title_of(*task.request), remark));
    const CallReport& made = workers_[slot].trace().calls;
    record.calls = Calls{.made = made.made,
                         .answered = made.answered,
                         .verified = task.verdict.afresh,
                         .failed = task.verdict.afresh_failed};
    if (task.verdict.afresh > task.verdict.afresh_failed) return;
    for (auto* each : {&record.verified, &record.found})
      for (auto& [tolerance, is_met] : *each) is_met.reset();
  }

  // At once, and again at the end.
  void say_new_remarks() {
    constexpr std::int64_t kNanoseconds = 1'000'000'000;
    const std::int64_t now = monotonic_nanoseconds();
    if (now < look_for_remarks_at_) return;
    look_for_remarks_at_ = now + kNanoseconds;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      Task& task = tasks_[i];
      if (!task.request || !is_elsewhere(task.request->problem)) continue;
      const auto remarks = remarks_in(workers_[i].output().text());
      for (; task.remarks < remarks.size(); ++task.remarks)
        say(stderr, fmt::format("{}: {}\n", title_of(*task.request), remarks[task.remarks]));
    }
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
    note_calls(slot, record);
    record.provenance.run = tasks_[slot].run;
    if (request.seed > 0 && !options_.keeps_fields) record.fields.reset();
    if (options_.keeps_output) record.output = worker.output().text();
    if (record.status == Status::crashed && record.output.empty())
      record.output = worker.output().last_words();
    std::optional<Record> earlier = store_.find(request);
    const bool is_repeated = !seen_.insert(record.cell).second;  // within this very call
    if (options_.redoes(earlier) && !is_repeated) earlier.reset();
    const auto doubt = doubtful_.find(&request);
    const bool was_done = doubt != doubtful_.end() && !doubt->second && earlier;
    const bool is_exact = earlier && !record.is_nondeterministic && !earlier->is_nondeterministic;
    if ((is_exact && !same_result(*earlier, record)) ||
        (doubt != doubtful_.end() && record.status != Status::interrupted &&
         doubt->second.value_or(record.status) != record.status))
      outcome_.conflicts.push_back(title_of(request));
    if (was_done) outcome_.uncount(*std::exchange(earlier, {}));
    if (doubt != doubtful_.end()) doubtful_.erase(doubt);
    if (earlier && !record.fields) record.fields = earlier->fields;  // its file is there
    if (earlier && !record.spectrum) record.spectrum = earlier->spectrum;
    outcome_.run += was_done ? 0 : 1;
    if (!earlier) outcome_.count(record);
    const std::int64_t now = monotonic_nanoseconds();
    const bool can_wait = tasks_[slot].is_shared && now - tasks_[slot].begun < kShort;
    if (tasks_[slot].is_shared) kept_[slot].finished.push_back(&request);
    const bool lacks_state = can_wait && !store_.has_states();
    unwritten_.emplace_back(&request, lacks_state || record.status == Status::interrupted);
    store_.keep(std::move(record), earlier);
    tasks_[slot] = {};
    if (!was_done) progress_.finished();
    if (!can_wait)
      flush();
    else if (unwritten_.size() == 1)
      flush_at_ = now + kLongestWait;
  }

  void flush() {
    flush_at_ = kNever;
    store_.flush();
    for (const auto& [request, leaves_states] : std::exchange(unwritten_, {})) {
      if (!leaves_states) store_.remove_checkpoint(*request);
      pending_.release(*request);
    }
  }

  // Records of short cells, which are soon computed again, wait for others. In nanoseconds.
  static constexpr std::int64_t kShort = 50'000'000, kLongestWait = 100'000'000;
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  const Catalog& catalog_;
  Store& store_;
  const RunOptions& options_;
  Outcome outcome_;
  int jobs_;
  std::vector<Worker> workers_;
  std::vector<Task> tasks_;
  std::vector<Kept> kept_;
  Judges judges_;
  DeclaredTimes declared_;  // for their limits
  Pending pending_;
  Progress progress_;
  std::set<std::string> seen_;
  // Cells that run again after a fault of a process, and how the cell of the fault itself ended.
  std::map<const Request*, std::optional<Status>> doubtful_;
  // And whether its checkpoint stays or it cannot have one.
  std::vector<std::pair<const Request*, bool>> unwritten_;
  std::int64_t flush_at_ = kNever;        // monotonic nanoseconds
  std::int64_t look_for_remarks_at_ = 0;  // monotonic nanoseconds
  bool has_said_ = false;                 // that it is finishing
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
