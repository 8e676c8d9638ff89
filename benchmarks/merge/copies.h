// The files of one part of several result folders, by name: only what stands in the folders, never
// what links in them lead to.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace isoline::benchmarks {

struct Copy {
  std::string text;
  std::size_t folder;  // its place in the list
};

class Part {
 public:
  // Folders whose part cannot be listed are named. They must outlive this.
  Part(const std::vector<std::filesystem::path>& folders, const char* part,
       std::vector<std::string>& unreadable);

  std::size_t size() const { return files_.size(); }
  const std::string& name(std::size_t file) const { return files_[file]->first; }
  // The texts of one name, once each, in an order of their own; those that are damaged are named.
  std::vector<Copy> copies(std::size_t file, std::vector<std::string>& unreadable) const;

 private:
  using Owners = std::map<std::string, std::vector<std::size_t>>;  // folders, by name

  const std::vector<std::filesystem::path>& folders_;
  const char* part_;
  Owners owners_;  // a path for each file would be a kilobyte
  std::vector<const Owners::value_type*> files_;
};

}  // namespace isoline::benchmarks
