// Threads of the libraries: one before main, more where a request says so.
#include "core/threads.h"

#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

extern "C" void openblas_set_num_threads(int threads);

namespace isoline {
namespace {

constexpr std::pair<const char*, const char*> kEnvironment[] = {
    {"OPENBLAS_NUM_THREADS", "1"},
    {"OMP_NUM_THREADS", "1"},
#ifdef ISOLINE_PORTABLE  // the same kernels on every machine
    {"OPENBLAS_CORETYPE", "Haswell"},
    {"ONEDNN_MAX_CPU_ISA", "AVX2"},
#endif
};

}  // namespace

void start_single_threaded(char** arguments) {
  bool is_set = true;
  for (const auto& [variable, wanted] : kEnvironment) {
    const char* value = std::getenv(variable);
    is_set = is_set && value != nullptr && std::strcmp(value, wanted) == 0;
    setenv(variable, wanted, 1);
  }
  if (!is_set) execv("/proc/self/exe", arguments);  // on failure we go on, with idle threads
}

void set_library_threads(int threads) {
  if (threads <= 1) return;
  openblas_set_num_threads(threads);
  omp_set_num_threads(threads);
}

int library_threads() { return omp_get_max_threads(); }

void run_tasks(Index tasks, const std::function<void(Index task, int thread)>& work) {
#pragma omp parallel for schedule(dynamic)
  for (Index task = 0; task < tasks; ++task) work(task, omp_get_thread_num());
}

OneThread::OneThread() : threads_(omp_get_max_threads()) { omp_set_num_threads(1); }
OneThread::~OneThread() { omp_set_num_threads(threads_); }

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
