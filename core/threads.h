// The processor as this process sees it, by its own CPUID instruction. Under an emulator this is
// the emulated processor, whereas the system's files describe the host.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/real.h"

namespace isoline {

struct Processor {
  std::string brand;                  // "Intel(R) Xeon(R) Processor"
  std::vector<std::string> features;  // vector instructions, named as Linux names them

  bool has(const std::string& feature) const;
};

// Read once. A feature counts where the system keeps its registers too.
const Processor& processor();

// How the libraries compute: on how many threads, with which kernels, for which caches. OpenBLAS
// starts its threads and chooses its kernels before main() when merely linked, so the program sets
// the environment and starts itself again, once, before anything else.

// The first line of every main(): one thread, the kernels that the processor has, the sizes of
// caches that this was built for. Replaces the process where the environment has to change.
void prepare_libraries(char** arguments);

// The kernel that OpenBLAS uses, and the origin of this choice: "OpenBLAS", "isoline", "user" or
// "portable".
struct LibraryKernel {
  std::string name, chosen_by;
};
LibraryKernel library_kernel();

std::string fourier_version();  // of FFTW: "3.3.10"; core/fourier.cpp has it

// The kernel to select in OpenBLAS: "SkylakeX" or "Haswell" if `own`, its choice, is below the
// processor's features; otherwise empty.
std::string better_kernel(const Processor& processor, const std::string& own);

// Bytes of the caches by which Eigen blocks its products. By default Eigen reads them from the
// processor, and gives other bits on another one.
struct CacheSizes {
  std::ptrdiff_t l1, l2, l3;
};
CacheSizes cache_sizes();

// Raises the libraries' threads in a worker, from the request.
void set_library_threads(int threads);
int library_threads();

// Calls work(task, thread) once for every task in [0, tasks), on all threads of the libraries. The
// assignment of tasks to threads is arbitrary; nothing may depend on it. The only adapter to
// OpenMP, whose threads begin with the first call, never before a fork.
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

// Receives from time to time how many tasks are done, and of how many.
using Listener = std::function<void(std::size_t done, std::size_t all)>;

// Calls work(0) … work(count − 1), each once, in any order. The listener is called by the calling
// thread alone. What a piece of work throws, others being done, is thrown to the caller.
void share(std::size_t count, const std::function<void(std::size_t)>& work,
           const Listener& listener = {});

}  // namespace isoline
