// Reads #include lines and follows them through the headers of the tree, breadth first.
#include "tests/structure/includes.h"

#include <algorithm>
#include <deque>
#include <regex>

namespace isoline {
namespace {

// The includes of every file of ours, read once.
const std::map<std::string, std::vector<Include>>& included() {
  static const std::map<std::string, std::vector<Include>> all = [] {
    static const std::regex pattern(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
    std::map<std::string, std::vector<Include>> found;
    for (const Source& source : sources()) {
      std::vector<Include>& own = found[source.path];
      std::smatch match;
      for (const std::string& line : source.lines)
        if (std::regex_search(line, match, pattern)) own.push_back({match[2], match[1] == "\""});
    }
    return found;
  }();
  return all;
}

}  // namespace

std::vector<Include> includes_of(const Source& source) { return included().at(source.path); }

std::optional<std::vector<std::string>> way_to(const Source& source, const std::string& header) {
  std::map<std::string, std::string> from = {{source.path, ""}};  // by whom each was included
  std::deque<std::string> open = {source.path};
  for (; !open.empty(); open.pop_front()) {
    const std::string file = open.front();
    if (!included().contains(file)) continue;  // generated
    for (const Include& include : included().at(file)) {
      if (include.is_quoted) {
        if (from.emplace(include.name, file).second) open.push_back(include.name);
      } else if (include.name.starts_with(header)) {
        std::vector<std::string> way = {include.name};
        for (std::string at = file; !at.empty(); at = from.at(at)) way.push_back(at);
        std::ranges::reverse(way);
        return way;
      }
    }
  }
  return std::nullopt;
}

}  // namespace isoline
