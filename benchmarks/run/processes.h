// What the system tells of its processes, read from /proc.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace isoline::benchmarks {

struct ProcessFigures {
  pid_t parent = 0;
  double processor_seconds = 0;  // its own and that of children that it has waited for
  std::int64_t resident_bytes = 0, address_space_bytes = 0;
};
std::optional<ProcessFigures> figures_of(pid_t process);  // nothing where it is gone

// Its resident memory, of what it shares with others its share alone: 0 where that is not told.
std::int64_t proportional_bytes(pid_t process);

std::vector<pid_t> children_of(pid_t process);  // of all its threads, those that ended included
std::vector<pid_t> processes_of_this_namespace();

// A mark that a process gives itself and all that descends from it inherit, whatever session or
// group they move to and whatever program they become; 0 where there is none.
void mark_this_process(std::uint64_t mark);
std::uint64_t mark_of(pid_t process);

}  // namespace isoline::benchmarks
