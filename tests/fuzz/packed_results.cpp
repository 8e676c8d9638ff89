// Archives of results.
#include <filesystem>
#include <stdexcept>

#include "benchmarks/archive/unpack.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

void packed_results(std::string_view bytes) {
  const MemoryFile file(bytes);
  expect_read_or_refused([&] {
    const benchmarks::UnpackedArchive unpacked(file.path());
    for (const auto& entry : std::filesystem::recursive_directory_iterator(unpacked.folder()))
      if (!entry.is_directory() && !entry.is_regular_file())
        throw std::logic_error("an archive made what is neither file nor folder");
  });
}

}  // namespace isoline::fuzz
