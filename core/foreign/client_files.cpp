// Clients, looked for beside the program.
#include "core/foreign/client_files.h"

#include <array>

namespace isoline {

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
