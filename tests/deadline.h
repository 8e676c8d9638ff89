// Waiting for what another process or thread does, which ends in a failed test and never hangs.
#pragma once

#include <chrono>
#include <concepts>
#include <stdexcept>
#include <thread>

namespace isoline {

// Asks each millisecond until `is_so` holds; std::runtime_error after two minutes. In a process
// that a test forked, where nothing would catch it, alarm(120) is the deadline instead.
void wait_until(std::predicate auto is_so) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!is_so()) {
    if (std::chrono::steady_clock::now() > end)
      throw std::runtime_error("waited two minutes for what did not happen");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace isoline
