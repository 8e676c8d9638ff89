// Unpacks what is an archive, and leaves the rest as it is named.
#include "benchmarks/cli/opened_results.h"

namespace isoline::benchmarks {

OpenedResults::OpenedResults(const std::vector<std::string>& given) : given_(given) {
  for (const std::string& path : given) {
    const bool is_packed = is_archive(path);
    if (is_packed) archives_.push_back(std::make_unique<UnpackedArchive>(path));
    folders_.push_back(is_packed ? archives_.back()->folder().string() : path);
  }
}

std::string OpenedResults::by_given_names(std::string text) const {
  for (std::size_t i = 0; i < given_.size(); ++i) {
    if (given_[i] == folders_[i]) continue;
    for (std::size_t at = text.find(folders_[i]); at != std::string::npos;
         at = text.find(folders_[i], at + given_[i].size()))
      text.replace(at, folders_[i].size(), given_[i]);
  }
  return text;
}

}  // namespace isoline::benchmarks
