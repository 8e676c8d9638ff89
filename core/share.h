// Work shared by threads, one a core: records to read, to hold to a schema, to merge.
#pragma once

#include <cstddef>
#include <functional>

namespace isoline {

// Is told now and then how many are done, of how many.
using Listener = std::function<void(std::size_t done, std::size_t all)>;

// Calls work(0) … work(count − 1), each once, in any order. The listener is called by the calling
// thread alone. What a piece of work throws, others being done, is thrown to the caller.
void share(std::size_t count, const std::function<void(std::size_t)>& work,
           const Listener& listener = {});

}  // namespace isoline
