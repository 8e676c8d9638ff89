// Shared mappings, and the list of those that this process has.
#include "benchmarks/run/shared_memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <vector>

namespace isoline::benchmarks {
namespace {

std::vector<const SharedMemory*>& all_of_this_process() {
  static std::vector<const SharedMemory*> all;
  return all;
}

}  // namespace

SharedMemory::SharedMemory(std::size_t bytes)
    : address_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                    MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0)),
      bytes_(bytes) {
  if (address_ == MAP_FAILED) throw std::bad_alloc();
  all_of_this_process().push_back(this);
}

SharedMemory::~SharedMemory() {
  std::erase(all_of_this_process(), this);
  munmap(address_, bytes_);
}

void SharedMemory::release_pages() { madvise(address_, bytes_, MADV_REMOVE); }

void SharedMemory::keep_only(std::initializer_list<const SharedMemory*> kept) {
  for (const SharedMemory* memory : all_of_this_process())
    if (std::ranges::find(kept, memory) == kept.end()) munmap(memory->address_, memory->bytes_);
}

}  // namespace isoline::benchmarks
