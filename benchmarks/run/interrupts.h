// Who asks this process to end while it runs cells, or examines what they need.
#pragma once

#include <csignal>

namespace isoline::benchmarks {

enum class Asked { nothing, finish, stop };

// While one lives, who asks this process to end is heard in order. Ctrl-C asks to finish what runs;
// a second one, a polite kill (of a scheduler, say) or a closed terminal ask to stop it; one more
// ends this process and all its cells at once. Ctrl-Z stops the cells too, until they all go on.
// A cell that asks its parent is not heard. Within another one it does nothing.
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
