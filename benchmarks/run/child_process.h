// What every isolated child does with itself, and what its end by a signal means.
#pragma once

#include <cstdint>

namespace isoline::benchmarks {

// Of the calling process, over what it has already: beyond that an allocation throws.
void limit_memory(std::int64_t bytes);

[[noreturn]] void leave();  // with its output written, and nothing else done

// A signal that somebody sends, a scheduler, a user or the kernel out of memory, as opposed to one
// that a fault of its own raises.
bool is_from_outside(int signal);

}  // namespace isoline::benchmarks
