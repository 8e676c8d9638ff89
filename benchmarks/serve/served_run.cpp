// The run loop turned inside out: the method is elsewhere, and calls.
#include "benchmarks/serve/served_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "benchmarks/run/execute.h"
#include "core/clock.h"

namespace isoline::benchmarks {

using optimizers::privileges_of;

namespace {

Problem problem_of(const Catalog& catalog, const Request& request) {
  const std::string& spec = request.problem.spec;
  require(!request.problem.is_learned, [&] {
    return fmt::format("{} learns a network; only problems of one x are served", spec);
  });
  Problem problem = make_problem(catalog, request.problem, request.seed);
  require(problem.samples() == 1 && problem.has_identity_network(),
          [&] { return fmt::format("{} has several samples; only one x is served", spec); });
  return problem;
}

// Of the oracles that were asked.
OracleSet asked_of(const Trace& trace) {
  OracleSet asked;
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (trace.last.counts[kind] > 0) asked.add(static_cast<Oracle>(kind));
  return asked;
}

}  // namespace

ServedRun::ServedRun(const Catalog& catalog, Request request)
    : request_(std::move(request)),
      problem_(problem_of(catalog, request_)),
      trace_(std::make_unique<Trace>()),
      meter_(problem_, request_.budget, problem_.offers(), *trace_) {}

void ServedRun::begin() {
  begun_ = monotonic_nanoseconds();
  provenance_ = {
      .started = instant_text(seconds_now()), .concurrent_jobs = 1, .is_exclusive = false};
  best_ = problem_.start();
  const Status status = meter_.begin(best_);
  best_loss_ = trace_->start_loss;
  if (status != Status::running) end(status);
}

Linearization& ServedRun::at(VectorRef x) {
  if (begun_ == 0) begin();
  asked_ = monotonic_nanoseconds();
  if (x_.size() == x.size() && x_ == x) return at_;
  x_ = x;
  meter_.linearize(x_, at_);
  take(x_, at_.loss());
  return at_;
}

void ServedRun::take(VectorRef x, Real loss) {
  if (record_ || !(loss < best_loss_)) return;
  best_loss_ = loss;
  best_ = x;
  const Status status = meter_.iterate(best_);
  if (status != Status::running) end(status);
}

// The time ends with the last call: nobody waits for the server to be stopped.
void ServedRun::end(Status verdict) {
  Trace& trace = *trace_;
  meter_.finish(best_, verdict);
  const double seconds = 1e-9 * static_cast<double>(asked_ - begun_);
  trace.last.wall_seconds = std::min(trace.last.wall_seconds, seconds);
  trace.point[trace.points - 1].wall_seconds = trace.last.wall_seconds;
  set_text(
      trace.privileges,
      fmt::format("{}", fmt::join(privileges_of(asked_of(trace), problem_.inverse_kind()), "\n")));
  if (trace.status == Status::converged)
    set_text(trace.message, "whoever asked has stopped asking, for reasons of its own");
  trace.is_finished = true;
  record_ = record_of(request_, trace);
  record_->is_nondeterministic = true;  // nobody here can repeat what was asked
  record_->provenance.run = provenance_;
}

std::optional<Record> ServedRun::record() {
  if (begun_ != 0 && !record_) end(Status::converged);
  return record_;
}

}  // namespace isoline::benchmarks
