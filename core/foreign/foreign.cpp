// The identity of an external program within a build.
#include "core/foreign/foreign.h"

#include <array>
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

// Clients, looked for beside the program.

namespace fs = std::filesystem;

fs::path client_folder(const std::string& language) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const std::array<fs::path, 3> candidates = {
      program.parent_path().parent_path() / "share/isoline" / language,
      fs::path(ISOLINE_CLIENTS) / language, fs::path(ISOLINE_INSTALLED_CLIENTS) / language};
  for (const fs::path& folder : candidates)
    if (fs::is_directory(folder, error)) return folder;
  return candidates.back();
}

}  // namespace isoline
