// Records found by their names, which tell cell and build.
#include "benchmarks/shard/adopted.h"

#include <algorithm>

#include "benchmarks/run/store.h"
#include "benchmarks/shard/split.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/field_frames.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

// False where it is gone, or is none: then the cell is run.
bool adopt(const fs::path& from, const fs::path& to) {
  try {
    if (const fs::path fields = field_path(from); is_there(fields))
      write_text(field_path(to), read_text(fields));
    write_text(to, read_text(from));
    return true;
  } catch (const UsageError&) {
    return false;
  }
}

}  // namespace

std::size_t adopt_records(const std::vector<Request>& requests, const fs::path& whole,
                          const fs::path& shard) {
  std::size_t adopted = 0;
  for (const fs::path& other : result_folders(whole)) {
    const std::vector<std::string> there = names_in(other / "runs");
    if (other == shard || there.empty()) continue;
    const Store store(shard);
    for (const Request& request : requests) {
      const std::string name = Store::name_of(request);
      if (!std::ranges::binary_search(there, name) || store.has(request)) continue;
      adopted += adopt(other / "runs" / name, shard / "runs" / name);
    }
  }
  return adopted;
}

}  // namespace isoline::benchmarks
