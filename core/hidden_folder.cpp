// Folders by mkdtemp.
#include "core/hidden_folder.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cerrno>
#include <cstring>

#include "core/errors.h"

namespace isoline {

HiddenFolder::HiddenFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "isoline-XXXXXX").string();
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
