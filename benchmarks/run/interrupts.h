// Handles signals that end this process while it runs or checks cells.
#pragma once

#include <csignal>

namespace isoline::benchmarks {

enum class Asked { nothing, finish, stop };

// While an object lives, signals end this process in order. The first Ctrl-C finishes the running
// cells; a second one, SIGTERM (from a scheduler, say) or a closed terminal stops them; one more
// ends this process and all its cells at once. Ctrl-Z also stops the cells until they continue
// together. Signals from a cell to its parent are ignored. Inside another object it does nothing.
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

Asked asked_to_end();  // so far, of the guard that lives

}  // namespace isoline::benchmarks
