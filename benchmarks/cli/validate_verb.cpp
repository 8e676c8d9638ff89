// isoline validate PATH...: are the records, plans, sheets, suites and rates what they claim to be?
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/merge/contradictions.h"
#include "benchmarks/plan/resources.h"
#include "core/errors.h"
#include "core/json.h"
#include "core/records/record.h"
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

// What is wrong with a file; and what it is known by, where it is a record.
struct Examined {
  std::vector<std::string> violations;
  std::optional<RecordIdentity> identity;
};

Examined examined_record(const Json& record, const fs::path& path) {
  Examined examined;
  if (std::string violation = cell_violation(record); !violation.empty())
    examined.violations.push_back(std::move(violation));
  examined.identity = RecordIdentity{path, record.at("cell"), record.at("build")};
  return examined;
}

Examined examined(const fs::path& path) {
  try {
    const Json document = read_json(path);
    if (document.is_object() && document.contains("$schema")) return {};  // a schema itself
    if (!document.is_object() || !document.contains("schema") || !document["schema"].is_string())
      return {{"it names no schema"}, {}};
    const auto claimed = document["schema"].get<std::string>();  // "isoline.run/1"
    const auto dot = claimed.find('.'), slash = claimed.find('/');
    const std::string name = claimed.substr(dot + 1, slash - dot - 1);
    const Schema* schema = schema_of(name);
    if (schema == nullptr) return {{fmt::format("unknown schema '{}'", claimed)}, {}};
    std::vector<std::string> violations = schema->violations(document);
    const bool is_sound_record = violations.empty() && claimed == kRunSchema;
    if (is_sound_record) return examined_record(document, path);
    return {std::move(violations), {}};
  } catch (const UsageError& error) {
    return {{error.what()}, {}};
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
  const std::vector<fs::path> files = files_under(given.paths);
  std::vector<Examined> all(files.size());
  share(
      files.size(), [&](std::size_t i) { all[i] = examined(files[i]); }, on_terminal("files"));
  std::map<fs::path, std::vector<std::string>> wrong;
  std::vector<RecordIdentity> records;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!all[i].violations.empty()) wrong[files[i]] = std::move(all[i].violations);
    if (all[i].identity) records.push_back(std::move(*all[i].identity));
  }
  for (DoubleRecord& record : double_records(std::move(records)))
    wrong[record.file].push_back(std::move(record.violation));
  for (const auto& [file, violations] : wrong)
    for (const std::string& violation : violations)
      fmt::print("{}: {}\n", file.string(), violation);
  fmt::print("{} files, {} wrong\n", files.size(), wrong.size());
  return wrong.empty() ? kGood : kWorse;
}

}  // namespace isoline::benchmarks
