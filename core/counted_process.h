// Programs that compute for this process: their processor time is its own.
#pragma once

#include <sys/types.h>

namespace isoline {

// Counted while it stands, and what was counted stays. Of the process itself, not of those that it
// starts.
class CountedProcess {
 public:
  explicit CountedProcess(pid_t process);
  ~CountedProcess();  // before the process is waited for
  CountedProcess(const CountedProcess&) = delete;
  CountedProcess& operator=(const CountedProcess&) = delete;

 private:
  pid_t process_;
};

double counted_processor_seconds();  // of all of them so far, user and system

}  // namespace isoline
