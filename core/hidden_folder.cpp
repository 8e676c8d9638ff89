// Folders by mkdtemp.
#include "core/hidden_folder.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/errors.h"
#include "core/text.h"

namespace isoline {

HiddenFolder::HiddenFolder() {
  std::error_code error;
  const std::filesystem::path among = std::filesystem::temp_directory_path(error);
  require(!error, [&] {
    const char* named = std::getenv("TMPDIR");
    return fmt::format("TMPDIR must name a folder for temporary files, got {}",
                       printable(named != nullptr ? named : "none"));
  });
  std::string pattern = (among / "isoline-XXXXXX").string();
  require(mkdtemp(pattern.data()) != nullptr, [&] {
    return fmt::format("cannot make a folder {}: {}", pattern, std::strerror(errno));
  });
  path_ = pattern;
}

HiddenFolder::~HiddenFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace isoline
