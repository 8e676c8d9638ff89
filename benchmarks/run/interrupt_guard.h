// While it lives, who asks this process to end is heard in order: Ctrl-C, a polite kill or a closed
// terminal raise a flag; the second of them ends this process and all its cells at once. Ctrl-Z
// stops the cells too, until they all go on.
#pragma once

#include <csignal>

namespace isoline::benchmarks {

class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool is_asked() const;  // whether somebody asked; a cell that asks its parent is not heard

 private:
  struct sigaction old_int_ {
  }, old_term_{}, old_hup_{}, old_stop_{};
};

}  // namespace isoline::benchmarks
