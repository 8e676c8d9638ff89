// Threads that take the next piece of work until none is left.
#include "core/share.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace isoline {

void share(std::size_t count, const std::function<void(std::size_t)>& work,
           const Listener& listener) {
  constexpr unsigned kMostThreads = 8;
  constexpr std::size_t kOften = 64;
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  const auto some = [&](const Listener& told) {
    try {
      for (std::size_t i = next++; i < count; i = next++) {
        work(i);
        if (told && i % kOften == 0) told(i + 1, count);
      }
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, kMostThreads);
    for (unsigned i = 1; i < threads && i < count; ++i) others.emplace_back(some, Listener());
    some(listener);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace isoline
