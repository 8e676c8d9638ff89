// The files of result folders, by name: as text, for each path that knows its parts is a kilobyte.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reports/read/study.h"

namespace isoline::reports {

// What stands in a folder under the name of JSON, whatever it is; where that cannot be told, why.
std::vector<std::string> json_files(const std::filesystem::path& folder,
                                    std::vector<Unreadable>& unreadable);

// Those of the records of all folders.
std::vector<std::string> record_files(const std::vector<std::string>& folders,
                                      std::vector<Unreadable>& unreadable);

}  // namespace isoline::reports
