// One run, in this process: the loop that every method runs in.
#pragma once

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/checkpoint.h"
#include "core/array.h"
#include "core/records/record.h"
#include "core/trace.h"

namespace isoline::benchmarks {

// θ₀ with each component moved by one unit in its last place, up or down by the stream
// (seed, problem, "last bit", number). A zero has none of its own: it takes that of the largest
// component, or of 1 where all are zero.
Vector perturbed_start(Vector start, const Request& request, int number);

// One run, in this process: the loop that every method runs in.

// Starts, steps and evaluates the method until it is done or to be stopped; the meter writes the
// trace. Returns the last θ.
Vector drive(Optimizer& method, Meter& meter, Vector theta, Checkpoint& checkpoint);

// Creates the components of the request and drives them. The status is in the trace in all cases:
// an exception ends as `failed`, `memory` or `inapplicable`, and a stopped run as `interrupted`.
// `returned` gets the last θ. A perturbation other than 0 moves the start in the last bit
// (runner.h).
void execute(const Catalog& catalog, const Request& request, Trace& trace,
             Checkpoint checkpoint = {}, Vector* returned = nullptr, int perturbation = 0);

// The record of a run from what it left behind.
Record record_of(const Request& request, const Trace& trace);

}  // namespace isoline::benchmarks
