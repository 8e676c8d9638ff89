// Moves the components of a start by one unit in the last place each.
#include "benchmarks/run/execute.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

#include "core/foreign/line.h"
#include "core/random.h"

namespace isoline::benchmarks {

Vector perturbed_start(Vector start, const Request& request, int number) {
  constexpr Real kUnit = std::numeric_limits<Real>::epsilon();  // of 1
  constexpr Real kAbove = std::numeric_limits<Real>::infinity();
  const Real largest = start.size() > 0 ? start.cwiseAbs().maxCoeff() : 0;
  const Real of_zero = kUnit * (largest > 0 ? largest : 1);
  Vector signs(start.size());
  RandomStream(request.seed, request.problem.name, "last bit", static_cast<std::uint64_t>(number))
      .signs(signs);
  for (Index i = 0; i < start.size(); ++i)
    start[i] = start[i] == 0 ? signs[i] * of_zero : std::nextafter(start[i], signs[i] * kAbove);
  return start;
}

// The run loop, and the verdict on it.

using optimizers::BudgetSpent;
using optimizers::privileges_of;
namespace {

void conclude(Trace& trace, Status status, std::string_view message) {
  trace.status = status;
  set_text(trace.message, message);
}

void run(const Catalog& catalog, const Request& request, Trace& trace, Checkpoint& checkpoint,
         Vector* returned, int perturbation) {
  const Problem problem = make_problem(catalog, request.problem, request.seed);
  const OptimizerEntry& entry = catalog.optimizers.at(request.optimizer.name);
  const std::string reason = why_inapplicable(entry, request.optimizer.options, problem);
  if (!reason.empty()) throw NotApplicable(reason);
  const auto method = entry.make(request.optimizer.options, catalog.optimizers);
  const OracleSet granted = needs_of(entry, request.optimizer.options, problem);
  set_text(trace.privileges,
           fmt::format("{}", fmt::join(privileges_of(granted, problem.inverse_kind()), "\n")));
  Meter meter(problem, request.budget, granted, trace);
  Vector start = problem.start();
  if (perturbation != 0) start = perturbed_start(std::move(start), request, perturbation);
  const Vector theta = drive(*method, meter, std::move(start), checkpoint);
  if (returned) *returned = theta;
}

// With other sizes the harness would read beyond the array.
void require_size(const Vector& theta, const Meter& meter) {
  if (theta.size() == meter.unknowns()) return;
  throw std::runtime_error(fmt::format(
      "the method changed the number of unknowns from {} to {}, which a step must not do",
      meter.unknowns(), theta.size()));
}

}  // namespace

Vector drive(Optimizer& method, Meter& meter, Vector theta, Checkpoint& checkpoint) {
  Status verdict = Status::running;
  Vector before;  // (n), where the step began
  try {
    if (!checkpoint.restore(method, meter, theta)) {
      before = theta;
      verdict = meter.begin(theta);
      if (verdict == Status::running) method.start(meter, theta);
    }
    while (verdict == Status::running) {
      before = theta;
      verdict = method.step(meter, theta);
      require_size(theta, meter);
      if (method.reports_iterations()) break;
      const Status judged = meter.iterate(theta);
      if (judged != Status::running) verdict = judged;
      if (verdict == Status::running && checkpoint.save_if_due(method, meter, theta)) return theta;
    }
  } catch (const BudgetSpent&) {  // during a step
    theta = before;
    verdict = Status::budget;
  }
  return meter.finish(theta, verdict);
}

void execute(const Catalog& catalog, const Request& request, Trace& trace, Checkpoint checkpoint,
             Vector* returned, int perturbation) {
  try {
    try {
      run(catalog, request, trace, checkpoint, returned, perturbation);
    } catch (const DamagedCheckpoint&) {  // which is set aside: from the beginning, then
      new (&trace) Trace;
      run(catalog, request, trace, checkpoint, returned, perturbation);
    }
    if (trace.status == Status::running)
      conclude(trace, Status::interrupted, "it was stopped, and saved its state");
  } catch (const NotApplicable& reason) {
    conclude(trace, Status::inapplicable, reason.what());
  } catch (const std::bad_alloc&) {
    conclude(trace, Status::memory, "out of its memory limit");
  } catch (const KilledProgram& error) {
    conclude(trace, Status::interrupted, error.what());
  } catch (const std::exception& error) {
    conclude(trace, Status::failed, error.what());
  } catch (...) {
    conclude(trace, Status::failed, "threw an object that is not a std::exception");
  }
}

}  // namespace isoline::benchmarks
