// Lists and reads what several folders have under one name.
#include "benchmarks/merge/copies.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.h"
#include "core/files.h"
#include "core/records/json_view.h"
#include "core/records/plan.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

Part::Part(const std::vector<fs::path>& folders, const char* part,
           std::vector<std::string>& unreadable)
    : folders_(folders), part_(part) {
  for (std::size_t i = 0; i < folders.size(); ++i) try {
      const fs::path folder = folders[i] / part;
      std::error_code unknown;
      require(!fs::is_symlink(folder, unknown), [&] {
        return fmt::format("{} is a symbolic link, which is not followed here", folder.string());
      });
      for (std::string& name : names_in(folder))
        if (!name.ends_with(".tmp")) owners_[std::move(name)].push_back(i);
    } catch (const UsageError& error) {
      unreadable.emplace_back(error.what());
    }
  for (const auto& file : owners_) files_.push_back(&file);
}

std::vector<Copy> Part::copies(std::size_t file, std::vector<std::string>& unreadable) const {
  static thread_local JsonReader reader;
  const auto& [name, owners] = *files_[file];
  std::vector<Copy> copies;
  for (const std::size_t folder : owners) try {
      const fs::path path = folders_[folder] / part_ / name;
      std::string text = read_text(path, kMostRecordBytes, Links::refused);
      if (std::ranges::find(copies, text, &Copy::text) != copies.end()) continue;
      if (name.ends_with(".json")) reader.parse(text, path.string());
      copies.push_back({std::move(text), folder});
    } catch (const UsageError& error) {
      unreadable.emplace_back(error.what());
    }
  std::ranges::sort(copies, {}, &Copy::text);
  return copies;
}

}  // namespace isoline::benchmarks
