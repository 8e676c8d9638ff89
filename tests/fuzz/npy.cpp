// Arrays in NumPy's file format.
#include "core/records/npy.h"

#include <stdexcept>

#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

void npy(std::string_view bytes) {
  const MemoryFile file(bytes);
  expect_read_or_refused([&] {
    const NumberArray array = read_npy(file.path());
    Index count = 1;
    for (const Index each : array.shape) count *= each;
    if (count != static_cast<Index>(array.values.size()))
      throw std::logic_error("a shape that does not hold its numbers");
  });
}

}  // namespace isoline::fuzz
