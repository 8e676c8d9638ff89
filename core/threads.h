// How many threads the libraries use. OpenBLAS starts its own before main() when merely linked, so
// the program sets the environment and starts itself again, once, before anything else.
#pragma once

#include <cstddef>
#include <functional>

#include "core/real.h"

namespace isoline {

// Returns at once where the environment already asks for one thread; else replaces this process.
void start_single_threaded(char** arguments);

// Raises the libraries' threads in a worker, from the request.
void set_library_threads(int threads);
int library_threads();

// Calls work(task, thread) once for every task in [0, tasks), on all threads of the libraries. Who
// takes which task is left to chance, so nothing may depend on it. The only door to OpenMP, whose
// threads begin with the first call: never before a fork.
void run_tasks(Index tasks, const std::function<void(Index task, int thread)>& work);

template <class Work>
void for_each_task(Index tasks, const Work& work) {
  run_tasks(tasks, std::cref(work));  // a reference, for which nothing is allocated
}

// While it lives, OpenMP grants one thread.
class OneThread {
 public:
  OneThread();
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int threads_;
};

// Is told now and then how many are done, of how many.
using Listener = std::function<void(std::size_t done, std::size_t all)>;

// Calls work(0) … work(count − 1), each once, in any order. The listener is called by the calling
// thread alone. What a piece of work throws, others being done, is thrown to the caller.
void share(std::size_t count, const std::function<void(std::size_t)>& work,
           const Listener& listener = {});

}  // namespace isoline
