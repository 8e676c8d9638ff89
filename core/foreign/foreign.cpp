// What another program's part in a build is known by.
#include "core/foreign/foreign.h"

#include <filesystem>

#include "core/digest.h"
#include "core/files.h"

namespace isoline {

namespace fs = std::filesystem;

std::string digest_of_files(std::span<const std::string> words) {
  std::string all;
  for (const std::string& word : words) {
    std::error_code error;
    if (fs::is_regular_file(word, error)) all += digest(read_text(word)) + "\n";
  }
  return digest(all);
}

// Not of its label, note and source, which are words about it.
std::string digest_of(const Foreign& foreign) {
  std::string all = foreign.door + "\n" + foreign.command + "\n" + foreign.digest + "\n" +
                    foreign.interpreter + "\n";
  for (const auto& [name, version] : foreign.packages)
    all.append(name).append(" ").append(version).append("\n");
  return digest(all);
}

}  // namespace isoline
