// Our own source files, as text, for tests that read them.
#pragma once

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "core/files.h"

namespace isoline {

struct Source {
  std::string path;  // from the root of the tree: "core/array.h"
  std::string text;
  std::vector<std::string> lines;

  bool is_header() const { return path.ends_with(".h"); }
  bool is_test() const { return path.starts_with("tests/"); }
  std::string room() const { return path.substr(0, path.find('/')); }
  std::string folder() const { return path.substr(0, path.rfind('/')); }
  std::string stem() const { return std::filesystem::path(path).stem(); }
};

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) lines.push_back(line);
  return lines;
}

inline std::string without_comment(const std::string& line) {
  return line.substr(0, line.find("//"));
}

inline const std::filesystem::path& root() {
  static const std::filesystem::path path = ISOLINE_SOURCE_DIR;
  return path;
}

// Every .h and .cpp of every room.
inline const std::vector<Source>& sources() {
  static const std::vector<Source> all = [] {
    std::vector<Source> found;
    for (const char* room :
         {"core", "networks", "problems", "optimizers", "benchmarks", "reports", "tests"})
      for (const auto& entry : std::filesystem::recursive_directory_iterator(root() / room)) {
        const std::string extension = entry.path().extension();
        if (extension != ".h" && extension != ".cpp") continue;
        const std::string text = read_text(entry.path());
        found.push_back(
            {std::filesystem::relative(entry.path(), root()).string(), text, lines_of(text)});
      }
    return found;
  }();
  return all;
}

}  // namespace isoline
