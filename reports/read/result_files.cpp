// Lists result folders.
#include "reports/read/result_files.h"

#include "core/errors.h"
#include "core/files.h"

namespace isoline::reports {

std::vector<std::string> json_files(const std::filesystem::path& folder,
                                    std::vector<Unreadable>& unreadable) {
  std::vector<std::string> files;
  try {
    for (const std::string& name : names_in(folder))
      if (name.ends_with(".json")) files.push_back((folder / name).string());
  } catch (const UsageError& error) {
    unreadable.push_back({folder.string(), error.what()});
  }
  return files;
}

std::vector<std::string> record_files(const std::vector<std::string>& folders,
                                      std::vector<Unreadable>& unreadable) {
  std::vector<std::string> all;
  for (const std::filesystem::path folder : folders)
    for (std::string& file : json_files(folder / "runs", unreadable))
      all.push_back(std::move(file));
  return all;
}

}  // namespace isoline::reports
