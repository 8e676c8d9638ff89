// One run in this process: the loop that every method runs in, and its state on disk, from which a
// stopped run continues.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "benchmarks/plan/catalog.h"
#include "core/array.h"
#include "core/records/record.h"
#include "core/trace.h"
#include "optimizers/optimizer.h"

namespace isoline::benchmarks {

struct DamagedCheckpoint : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// States of runs that their budget of iterations or work ended, from which the same run with a
// larger budget continues.
struct EndStates {
  std::filesystem::path stem;  // of their files, which identifies the run; empty: none is kept
  std::filesystem::path from;  // the one to continue from; empty: none
  double least_seconds = 0;    // a shorter run is not worth a file
};

class Checkpoint {
 public:
  Checkpoint() = default;  // keeps nothing
  // `identity` names the owner of the state: a file of another cell or build is not touched.
  Checkpoint(std::filesystem::path path, std::string identity, double every_seconds);

  // Restores method, meter and θ if there is a state. The method is started. DamagedCheckpoint
  // where a file claims to be such a state and is invalid: it is moved away, the arguments are
  // overwritten.
  bool restore(Optimizer& method, Meter& meter, Vector& theta);
  void continue_from(EndStates ends) { ends_ = std::move(ends); }
  // Whose end is kept; both outlive this.
  void watch(const Trace& trace, const Budget& budget) { trace_ = &trace, budget_ = &budget; }
  // Writes the state if the last time is long enough ago, or if the process is to stop: then
  // returns true. If the disk refuses, the run continues without.
  bool save_if_due(Optimizer& method, Meter& meter, Vector& theta);
  // For a run that its budget has ended: writes the last state noted before its end.
  void keep_end();

 private:
  bool restore_from(const std::filesystem::path& path, const std::string& identity,
                    Optimizer& method, Meter& meter, Vector& theta);
  void note_end(Optimizer& method, Meter& meter, Vector& theta);

  std::filesystem::path path_;
  std::string identity_;
  double every_seconds_ = 0;
  std::int64_t last_nanoseconds_ = 0;
  EndStates ends_;
  const Trace* trace_ = nullptr;
  const Budget* budget_ = nullptr;
  std::string end_;  // the last state noted, its iteration, and the least budget that leads there
  std::int64_t noted_ = -1;
  Budget needed_;
};

// θ₀ with each component moved by one unit in its last place, up or down by the stream
// (seed, problem, "last bit", number). A zero has none of its own: it takes that of the largest
// component, or of 1 where all are zero.
Vector perturbed_start(Vector start, const Request& request, int number);

// Starts, steps and evaluates the method until it is done or to be stopped; the meter writes the
// trace. Returns the last θ.
Vector drive(Optimizer& method, Meter& meter, Vector theta, Checkpoint& checkpoint);

// Creates the components of the request and drives them. The status is in the trace in all cases:
// an exception ends as `failed`, `memory` or `inapplicable`, and a stopped run as `interrupted`.
// `returned` gets the last θ, and is the start if it is not empty. A perturbation other than 0
// moves the start in the last bit.
void execute(const Catalog& catalog, const Request& request, Trace& trace,
             Checkpoint checkpoint = {}, Vector* returned = nullptr, int perturbation = 0);

// The record of a run from its trace, which is sound (core/trace.h says what that is).
Record record_of(const Request& request, const Trace& trace);

}  // namespace isoline::benchmarks
