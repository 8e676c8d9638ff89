// A folder of one's own among the temporary ones, which nobody finds by its name.
#pragma once

#include <filesystem>

namespace isoline {

// Goes with its scope, and all that is in it. UsageError where it cannot be made.
class HiddenFolder {
 public:
  HiddenFolder();
  ~HiddenFolder();
  HiddenFolder(const HiddenFolder&) = delete;
  HiddenFolder& operator=(const HiddenFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace isoline
