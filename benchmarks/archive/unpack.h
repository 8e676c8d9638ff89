// An archive of results as the folder that it was made of, for those who read folders.
#pragma once

#include <filesystem>

#include "core/hidden_folder.h"

namespace isoline::benchmarks {

// By its name: "results.tar.gz", "results.tgz".
bool is_archive(const std::filesystem::path& path);

// Unpacked into a folder of its own, which goes with this. Nothing of an archive is believed:
// its files are those of its manifest, each once, with the size and the SHA-256 that stand there,
// plain ones and below the folder; else a UsageError says what is wrong.
class UnpackedArchive {
 public:
  explicit UnpackedArchive(const std::filesystem::path& archive);

  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  HiddenFolder folder_;
};

}  // namespace isoline::benchmarks
