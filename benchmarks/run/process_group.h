// A child process and all its descendants, as one group: started, measured, stopped, killed and
// reaped together. Descendants cannot escape by a session of their own or by outliving their
// parent: this process is a subreaper, and every descendant carries the mark of its group.
//
// A process with the rights of the user can still end this process by SIGKILL;
// docs/running-a-matrix.md states the limits.
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
  std::int64_t resident_bytes = 0, address_space_bytes = 0;
};
std::optional<ProcessFigures> figures_of(pid_t process);  // nothing where it is gone

// Its resident memory, with its share of shared pages; 0 if the system does not report it.
std::int64_t proportional_bytes(pid_t process);

std::vector<pid_t> children_of(pid_t process);  // of all its threads, those that ended included
std::vector<pid_t> processes_of_this_namespace();

// A mark that a process sets and all its descendants inherit, in every session, group and program;
// 0 if there is no mark.
void mark_this_process(std::uint64_t mark);
std::uint64_t mark_of(pid_t process);

// Signals that wait while a child is made: one that it sends at once must find it in the table of
// this process' children.

class HeldSignals {
 public:
  HeldSignals() {
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, &before_);
  }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  ~HeldSignals() { release(); }
  void release() const { sigprocmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_;
};

// The setup of every isolated child, and the meaning of its end by a signal.

// Limits the memory of this process beyond its present use: a larger allocation throws.
void limit_memory(std::int64_t bytes);

[[noreturn]] void leave();  // with its output written, and nothing else done

std::string signal_name(int signal);  // "signal 11 (Segmentation fault)"

// The end of a child without an answer: "signal … ended it", "it exited …".
std::string end_of_process(int wait_status);

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
  };

  ProcessGroup() = default;
  ~ProcessGroup();  // kills what still runs
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;

  // The child does `work`, then leaves by _exit(0): it must not throw. Its input is empty, Ctrl-C
  // does not reach it, and it dies with this process.
  void start(const std::function<void()>& work);
  bool is_running() const { return leader_ > 0; }
  pid_t leader() const { return leader_; }
  int descriptor() const { return descriptor_; }  // readable when the child has ended

  Usage usage(std::int64_t exact_above_bytes);  // memory is shared out exactly where it is more
  void ask_to_end() const;                      // the child alone: the others end with it
  void kill();                                  // all, at once; to be collected as any that ended
  // How the child ended, once it has and all that it left behind is killed and reaped.
  std::optional<End> collect();
  End end();  // kills all of one that runs, and waits until they are gone

 private:
  std::vector<pid_t> strays();
  std::vector<pid_t> members();
  void reap_strays();
  void leave_table();

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

// To every group of this process; for handlers of signals.
void signal_all_groups(int signal) noexcept;
// Whether a process belongs to one of our process groups; for signal handlers.
bool is_of_a_group(pid_t process) noexcept;

}  // namespace isoline::benchmarks
