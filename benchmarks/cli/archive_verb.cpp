// isoline archive DIR --out FILE.tar.gz: results as one file that others can cite.
#include <fmt/format.h>

#include "benchmarks/archive/pack.h"
#include "benchmarks/archive/unpack.h"
#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;

int archive_verb(const ArchiveArguments& given, Session&) {
  require(is_archive(given.out), [&] {
    return fmt::format("--out must be a file that ends in .tar.gz or .tgz, got {}", given.out);
  });
  const std::filesystem::path folder = std::filesystem::path(given.out).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  const Packed packed = pack_results(given.folder, given.out, on_terminal("files"));
  for (const std::string& name : packed.left_out)
    say(stderr, fmt::format("left out: {} is no plain file\n", name));
  say(stdout, fmt::format("{}: {} in {}\n", given.out, counted(packed.records, "record"),
                          counted(packed.files, "file")));
  return kGood;
}

}  // namespace isoline::benchmarks
