// Signals that ask this process to end while it runs cells, or checks their components.
#pragma once

#include <csignal>

namespace isoline::benchmarks {

enum class Asked { nothing, finish, stop };

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
  struct sigaction old_int_ {
  }, old_term_{}, old_hup_{}, old_stop_{};
};

Asked asked_to_end();  // what the signals since the outermost guard began ask for

}  // namespace isoline::benchmarks
