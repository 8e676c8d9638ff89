// How a run ended.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace isoline {

enum class Status {
  running,
  converged,     // the method stopped by its own test
  target,        // the harness measured L at or below the target
  budget,        // iterations, work or time are spent
  stalled,       // no relative decrease above 1e-12 in 100 iterations
  diverged,      // the loss is not finite, or above 1e12 times its start
  inapplicable,  // the cell cannot exist; the message says why
  failed,        // an exception; the message is its text
  crashed,       // a signal ended the process
  timeout,       // killed at the hard time limit
  memory,        // out of its memory limit
  interrupted,   // the user stopped the run
};
inline constexpr std::array<std::string_view, 12> kStatusNames = {
    "running",      "converged", "target",  "budget",  "stalled", "diverged",
    "inapplicable", "failed",    "crashed", "timeout", "memory",  "interrupted"};

inline std::string_view name_of(Status status) {
  return kStatusNames[static_cast<std::size_t>(status)];
}

inline std::optional<Status> status_of(std::string_view name) {
  for (std::size_t i = 0; i < kStatusNames.size(); ++i)
    if (kStatusNames[i] == name) return static_cast<Status>(i);
  return std::nullopt;
}

// The cell went wrong, as opposed to the method doing badly.
inline bool is_failure(Status status) {
  return status == Status::failed || status == Status::crashed || status == Status::timeout ||
         status == Status::memory;
}

}  // namespace isoline
