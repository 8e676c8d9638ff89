// Reads the list of cells that NEW may lack, and looks subjects up in it.
#include "reports/compare/allowed.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"

namespace isoline::reports {
namespace {

bool names(const std::string& pattern, const Given& given) {
  return matches(pattern, given.name) || matches(pattern, given.asked) ||
         matches(pattern, given.spec);
}

}  // namespace

// Greedy, with one place to come back to: the last star, which takes one letter more each time.
bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0, star = std::string_view::npos, taken = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++taken;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

AllowedList allowed_from_json(const Json& json) {
  try {
    require(json.at("schema") == kAllowedSchema,
            [&] { return fmt::format("the schema is not {}", kAllowedSchema); });
    AllowedList list;
    for (const Json& cells : json.at("cells")) {
      require(cells.contains("problem") || cells.contains("optimizer"),
              "an entry of the allowed cells names neither a problem nor an optimizer");
      list.push_back({.problem = cells.value("problem", std::string("*")),
                      .optimizer = cells.value("optimizer", std::string("*")),
                      .reason = cells.at("reason").get<std::string>()});
      require(!list.back().reason.empty(), "an entry of the allowed cells gives no reason");
    }
    return list;
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("no {}: {}", kAllowedSchema, error.what()));
  }
}

AllowedList read_allowed(const std::filesystem::path& file) {
  return allowed_from_json(read_json(file));
}

AllowedList::const_iterator entry_for(const AllowedList& list, const Subject& subject) {
  return std::ranges::find_if(list, [&](const AllowedCells& cells) {
    return names(cells.problem, subject.problem) && names(cells.optimizer, subject.optimizer);
  });
}

}  // namespace isoline::reports
