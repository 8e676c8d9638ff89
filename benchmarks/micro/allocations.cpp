// Counts what is allocated: Eigen, the C++ library and LAPACKE all come to malloc, which a program
// may define for itself and its shared libraries. The sanitizers define it too, so not with them.
#include <cstddef>

#include "benchmarks/micro/pairs.h"

namespace {
std::int64_t calls = 0;  // plain: the program has one thread
}

#ifndef ISOLINE_SANITIZE
extern "C" {
// glibc's own, under a second name that is not ours to choose.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming)
void* __libc_malloc(std::size_t size);

__attribute__((visibility("default"))) void* malloc(std::size_t size) noexcept {
  ++calls;
  return __libc_malloc(size);
}
}
#endif

namespace isoline::benchmarks::micro {

std::int64_t allocations() { return calls; }

}  // namespace isoline::benchmarks::micro
