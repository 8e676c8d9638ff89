// A child process and all its descendants, as one group: started, measured, stopped, killed and
// reaped together. Descendants cannot escape by a session of their own or by outliving their
// parent: this process is a subreaper, and every descendant carries the mark of its group. Only
// SIGKILL of this process escapes it (docs/running-a-matrix.md). Also handles the signals that ask
// this process to end while it has such children.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/foreign/foreign.h"

namespace isoline::benchmarks {

struct ProcessFigures {
  pid_t parent = 0;
  double processor_seconds = 0;  // its own and that of children that it has waited for
  double waiting_seconds = 0;    // of its first thread, runnable without a processor
  std::int64_t resident_bytes = 0;
};
std::optional<ProcessFigures> figures_of(pid_t process);  // nothing where it is gone

std::vector<pid_t> children_of(pid_t process);  // of all its threads, those that ended included

// Limits the memory of this process beyond its present use: a larger allocation throws.
void limit_memory(std::int64_t bytes);

std::string signal_name(int signal);          // "signal 11 (Segmentation fault)"
std::string end_of_process(int wait_status);  // without an answer: "signal … ended it"

class ProcessGroup {
 public:
  struct End {
    int wait_status = 0;                 // of the child itself, as wait() has it
    std::int64_t peak_memory_bytes = 0;  // of the child, or of all together where that was more
  };
  struct Usage {
    std::size_t processes = 0;
    double processor_seconds = 0;  // of those that have ended too, once their parent has waited
    std::int64_t resident_bytes = 0;
    double waiting_seconds = 0;  // for a processor, of the first threads of those that run
  };

  ProcessGroup() = default;
  ~ProcessGroup() { end(); }
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;

  // The child does `work`, then leaves by _exit(0): it must not throw. Its input is empty, Ctrl-C
  // does not reach it, and it dies with this process.
  void start(const std::function<void()>& work);
  bool is_running() const { return leader_ > 0; }
  int descriptor() const { return descriptor_; }  // readable when the child has ended

  Usage usage(std::int64_t exact_above_bytes);  // memory is shared out exactly where it is more
  void ask_to_end() const;                      // the child alone: the others end with it
  void kill();                                  // all, at once; to be collected as any that ended
  // How the child ended, once it has and all that it left behind is killed and reaped.
  std::optional<End> collect();
  End end();  // kills all of one that runs, and waits until they are gone

 private:
  std::vector<pid_t> strays();
  void reap_strays();

  pid_t leader_ = 0;
  int descriptor_ = -1;
  std::size_t slot_ = 0;
  std::uint64_t mark_ = 0;
  std::int64_t reaped_ = 0;  // strays so far, and what they used
  double reaped_seconds_ = 0;
  std::int64_t peak_bytes_ = 0;
};

// Processes of cells whose program was killed by SIGKILL, and so could not end them.
void end_what_killed_runs_left();

// SIGTERM and SIGHUP that a program sends to this process, which started it, are ignored from now
// on, in all verbs.
void ignore_signals_of_children();

// While a guard exists, Ctrl-C asks to finish the running cells. A second Ctrl-C, SIGTERM (of a
// scheduler, for example) or a closed terminal asks to stop them; one more ends this process and
// all cells at once. Ctrl-Z stops the cells too, until all continue. Signals that a cell sends to
// its parent are ignored. A guard within another one does nothing.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  bool is_outermost_;
};

enum class Asked { nothing, finish, stop };
Asked asked_to_end();  // what the signals since the outermost guard began ask for

}  // namespace isoline::benchmarks
