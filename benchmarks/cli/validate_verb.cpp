// isoline validate PATH...: are the records, plans, sheets, suites and rates what they claim to be?
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/resources.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/records/schema.h"
#include "core/threads.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// The schema of that name, read once a thread.
const Schema* schema_of(const std::string& name) {
  static thread_local std::map<std::string, Schema> known;
  if (const auto at = known.find(name); at != known.end()) return &at->second;
  const auto found = builtin_schemas().find(name);
  if (found == builtin_schemas().end()) return nullptr;
  return &known.try_emplace(name, parse_json(std::string(found->second), name)).first->second;
}

std::vector<std::string> violations_in(const fs::path& path) {
  try {
    const Json document = read_json(path);
    if (document.is_object() && document.contains("$schema")) return {};  // a schema itself
    if (!document.is_object() || !document.contains("schema") || !document["schema"].is_string())
      return {"it names no schema"};
    const auto claimed = document["schema"].get<std::string>();  // "isoline.run/1"
    const auto dot = claimed.find('.'), slash = claimed.find('/');
    const std::string name = claimed.substr(dot + 1, slash - dot - 1);
    const Schema* schema = schema_of(name);
    if (schema == nullptr) return {fmt::format("unknown schema '{}'", claimed)};
    return schema->violations(document);
  } catch (const UsageError& error) {
    return {error.what()};
  }
}

std::vector<fs::path> files_under(const std::vector<std::string>& paths) {
  std::vector<fs::path> files;
  for (const fs::path path : paths) {
    require(fs::exists(path),
            [&] { return fmt::format("no such file or folder: {}", path.string()); });
    if (!fs::is_directory(path))
      files.push_back(path);
    else
      for (const auto& entry : fs::recursive_directory_iterator(path))
        if (entry.is_regular_file() && entry.path().extension() == ".json")
          files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

int validate_verb(const ValidateArguments& given, Session&) {
  std::size_t wrong = 0;
  const std::vector<fs::path> files = files_under(given.paths);
  std::vector<std::vector<std::string>> violations(files.size());
  share(
      files.size(), [&](std::size_t i) { violations[i] = violations_in(files[i]); },
      on_terminal("files"));
  for (std::size_t i = 0; i < files.size(); ++i) {
    wrong += !violations[i].empty();
    for (const std::string& violation : violations[i])
      fmt::print("{}: {}\n", files[i].string(), violation);
  }
  fmt::print("{} files, {} wrong\n", files.size(), wrong);
  return wrong > 0 ? kWorse : kGood;
}

}  // namespace isoline::benchmarks
