// The status of a run, its budget, the success criterion of its problem with the targets, and the
// exit codes of the program.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "core/real.h"

namespace isoline {

enum class Status {
  running,
  converged,    // the method stopped by its own test, and the harness found a solution there
  unconfirmed,  // the method stopped by its own test, and the harness did not; the message says why
  target,       // the harness measured L at or below the target
  discrepancy,  // the harness measured ‖y − y*‖ at or below τδ, with δ the noise level
  budget,       // iterations, work or time are spent
  stalled,      // no relative decrease above 1e-12 in Budget::stall iterations
  diverged,     // the loss is not finite, or above 1e12 times its start
  inapplicable,  // the cell cannot exist; the message says why
  failed,        // an exception; the message is its text
  crashed,       // a signal ended the process
  timeout,       // killed at the hard time limit
  memory,        // out of its memory limit
  interrupted,   // the user stopped the run
};
inline constexpr std::array<std::string_view, 14> kStatusNames = {
    "running",  "converged",    "unconfirmed", "target",  "discrepancy", "budget", "stalled",
    "diverged", "inapplicable", "failed",      "crashed", "timeout",     "memory", "interrupted"};

inline std::string_view name_of(Status status) {
  return kStatusNames[static_cast<std::size_t>(status)];
}

// The choice of this name among those that `names` lists in order.
template <class Choice>
std::optional<Choice> choice_named(std::string_view name, const auto& names) {
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) return std::nullopt;
  return static_cast<Choice>(at - names.begin());
}
inline std::optional<Status> status_of(std::string_view name) {
  return choice_named<Status>(name, kStatusNames);
}

// The cell went wrong, as opposed to the method doing badly.
inline bool is_failure(Status status) {
  return status == Status::failed || status == Status::crashed || status == Status::timeout ||
         status == Status::memory;
}

// The success criterion of a problem: a small loss, or the true x.

enum class Aim {
  loss,  // f − f_L ≤ τ s: the loss is reached, whatever x
  x,     // the error in x is at most τ times the solution's norm: x is found
};
inline constexpr std::array<std::string_view, 2> kAimNames = {"loss", "x"};

inline std::string_view name_of(Aim aim) { return kAimNames[static_cast<std::size_t>(aim)]; }

inline std::optional<Aim> aim_of(std::string_view name) {
  return choice_named<Aim>(name, kAimNames);
}

// The budget of a run, and the loss at which it is done.

inline constexpr std::int64_t kStallIterations = 100;

struct Budget {
  std::int64_t iterations = 1000;
  std::int64_t work = std::numeric_limits<std::int64_t>::max();  // nominal costs, in forwards
  double seconds = std::numeric_limits<double>::infinity();      // soft; hard is twice that
  // τ of f ≤ f_L + τ s, or, if the criterion is x, of the error in x: f ≤ f_L + τ² s. 0 continues
  // to the end of the budget.
  double target = 1e-10;
  // Iterations without progress after which it is stalled; empty: the standard; 0: never.
  std::optional<std::int64_t> stall = {};
  // τ of the discrepancy principle: on a problem with noise of level δ, the first iterate with
  // ‖y − y*‖ ≤ τδ ends the run, in place of the target. 0: not used.
  double discrepancy = 0;
};

// The exit code of every verb.

enum ExitCode {
  kGood = 0,
  kUsage = 1,          // the caller's mistake
  kWorse = 2,          // than before; or cells failed
  kBetterOnly = 3,     // than before, in something, and nowhere worse
  kNotComparable = 4,  // at least in part
  kInterrupted = 130   // what a shell expects after Ctrl-C
};

// The ladder of targets by which runs are compared: τ_j = 10^(−j/5), j = 0 … 50.

inline constexpr int kRungs = 51;
inline Real rung(std::size_t j) { return std::pow(10.0, -static_cast<Real>(j) / 5); }

// The first rung at or below a tolerance, so the next stricter one where it lies between two; the
// last one where none is so strict.
inline std::size_t rung_of(Real tau) {
  constexpr Real kRounding = 1e-9;
  std::size_t j = 0;
  while (j + 1 < kRungs && rung(j) > tau * (1 + kRounding)) ++j;
  return j;
}

// The error in x that counts as found at τ. A floor is measured: a tenth of it is its own error.
inline Real x_goal(Real tau, Real x_scale, Real x_floor) {
  constexpr Real kAboveFloor = 1.1;
  return std::max(tau * x_scale, kAboveFloor * x_floor);
}

// Which iterations a curve keeps: 0 to 100, then 32 a decade.
std::int64_t next_kept_after(std::int64_t iteration);

}  // namespace isoline
