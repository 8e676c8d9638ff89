// What every isolated child does with itself, and what its end by a signal means.
#pragma once

#include <cstdint>
#include <string>

namespace isoline::benchmarks {

// Of the calling process, over what it has already: beyond that an allocation throws.
void limit_memory(std::int64_t bytes);

[[noreturn]] void leave();  // with its output written, and nothing else done

// A signal that somebody sends, a scheduler, a user or the kernel out of memory, as opposed to one
// that a fault of its own raises.
bool is_from_outside(int signal);

std::string signal_name(int signal);  // "signal 11 (Segmentation fault)"

// Of a child that was to answer and did not: "it was ended by signal …", "it left …".
std::string end_of_answerer(int wait_status);

}  // namespace isoline::benchmarks
