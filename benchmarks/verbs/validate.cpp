// isoline validate PATH...: checks records, plans, component metadata, suites and rates against
// their schemas.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <tuple>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/merge/merge.h"
#include "benchmarks/plan/catalog.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "core/records/record.h"
#include "core/records/request.h"
#include "core/seeds.h"
#include "core/text.h"
#include "core/threads.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct ValidateArguments {
  std::vector<std::string> paths;
};

void declare(VerbArguments& verb, ValidateArguments& given) {
  verb.texts("PATH", given.paths, "Files, or folders to search for *.json").required();
}

// The schema of that name, read once per thread.
const Schema* schema_of(const std::string& name) {
  static thread_local std::map<std::string, Schema> known;
  if (const auto at = known.find(name); at != known.end()) return &at->second;
  const auto found = builtin_schemas().find(name);
  if (found == builtin_schemas().end()) return nullptr;
  return &known.try_emplace(name, parse_json(std::string(found->second), name)).first->second;
}

// The identity of a record, its place, and its data: their folder and instance, and noise level.
struct RecordIdentity {
  std::string file, cell, build, instance = {};
  Json noise_level = {};
  bool has_started = false;

  auto place() const {
    const std::size_t folder = file.find_last_of('/') + 1;
    return std::tuple(std::string_view(file).substr(0, folder), std::string_view(cell),
                      std::string_view(build));
  }
};

// The errors in a file; for a record, also its cell and build.
struct Examined {
  std::vector<std::string> violations;
  std::optional<RecordIdentity> identity;
};

// A copy under the name of another cell would stand for that cell.
std::string name_violation(const Json& record, const fs::path& path) {
  const std::string own = record_file_name(record.at("cell"), record.at("build"));
  return path.parent_path().filename() != "runs" || path.filename() == own
             ? ""
             : "its file has another name than its cell and build, which is " + own;
}

Examined examined_record(const Json& record, const std::string& path) {
  const Json &request = record.at("request"), parts = record.value("build_parts", Json::object());
  const std::string instance =
      fmt::format("{} {} {} {}", fs::path(path).parent_path().string(),
                  request.at("problem").at("spec").get<std::string>(),
                  instance_of(request.at("seed")), parts.value("problem", ""));
  Examined examined{.violations = {},
                    .identity = {{path, record.at("cell"), record.at("build"), instance,
                                  record.value("noise_level", Json()),
                                  record.at("summary").at("start_loss").is_number()}}};
  for (const std::string& each : {fields_violation(record, path), answer_violation(record, path),
                                  name_violation(record, path)})
    if (!each.empty()) examined.violations.push_back(each);
  return examined;
}

// "isoline.run/1": what a document says it is.
std::string claim_of(const Json& document) {
  if (!document.is_object()) return "";
  const auto claim = document.find("schema");
  return claim != document.end() && claim->is_string() ? claim->get<std::string>() : "";
}

Examined examined_document(const Json& document, const std::string& path) {
  if (document.is_object() && document.contains("$schema")) return {};  // a schema itself
  const std::string claimed = claim_of(document);
  if (claimed.empty()) return {{"it does not state its schema"}, {}};
  const auto dot = claimed.find('.'), slash = claimed.find('/');
  const std::string name = claimed.substr(dot + 1, slash - dot - 1);
  const Schema* schema = schema_of(name);
  if (schema == nullptr) return {{fmt::format("unknown schema '{}'", claimed)}, {}};
  std::vector<std::string> violations = schema->violations(document);
  if (violations.empty() && claimed == kRunSchema) return examined_record(document, path);
  return {std::move(violations), {}};
}

// Most of a record are columns, and the schema constrains only their elements: a record is valid if
// and only if its outline is. Errors are reported for the complete record.
Examined examined(const std::string& path) {
  try {
    const std::string text = read_text(path);
    const Json outline = outline_of(text, "it");
    if (claim_of(outline) == kRunSchema) {
      Examined found = examined_document(outline, path);
      if (found.identity) {
        for (std::string& broken : broken_invariants(record_from_text(text, "it")))
          found.violations.push_back(std::move(broken));
        return found;
      }
    }
    return examined_document(parse_json(text, "it"), path);
  } catch (const std::exception& error) {
    return {{error.what()}, {}};
  }
}

// Records come by the hundred thousand, and a path for each would be a kilobyte.
using Wrong = std::map<std::string, std::vector<std::string>>;

// Whatever stands in a folder, or below it, under the name of JSON; no link leads to another
// folder.
void add_files(const fs::path& folder, std::vector<std::string>& files, Wrong& wrong) {
  try {
    for (const std::string& name : names_in(folder)) {
      const fs::path path = folder / name;
      std::error_code unknown;
      const bool is_folder = fs::is_directory(fs::symlink_status(path, unknown));
      if (is_folder) add_files(path, files, wrong);
      if (name.ends_with(".json")) files.push_back(path.string());
    }
  } catch (const UsageError& error) {
    wrong[folder.string()].emplace_back(error.what());
  }
}

std::vector<std::string> files_under(const std::vector<std::string>& paths, Wrong& wrong) {
  std::vector<std::string> files;
  for (const fs::path path : paths) {
    require(is_there(path),
            [&] { return fmt::format("{}: no such file or folder", path.string()); });
    std::error_code unknown;
    if (fs::is_directory(path, unknown))
      add_files(path, files, wrong);
    else
      files.push_back(path.string());
  }
  std::ranges::sort(files);
  return files;
}

// The files that SHA256SUMS of a result folder lists and the folder lacks, and the
// reverse for what reports read. `sha256sum -c` checks the digests and cannot find additional
// files.
void compare_with_manifest(const fs::path& folder, Wrong& wrong) {
  const fs::path manifest = folder / "SHA256SUMS";
  if (!is_there(manifest)) return;
  constexpr std::size_t kDigest = 64;
  std::set<fs::path> listed;
  std::istringstream lines(read_text(manifest));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#') || line.size() <= kDigest + 2) continue;
    const fs::path file = (folder / line.substr(kDigest + 2)).lexically_normal();
    listed.insert(file);
    if (!is_there(file))
      wrong[manifest.string()].push_back(
          fmt::format("{} is missing, but SHA256SUMS lists it", file.string()));
  }
  for (const char* part : {"runs", "components"}) {
    if (!is_there(folder / part)) continue;
    for (const std::string& name : names_in(folder / part))
      if (const fs::path file = (folder / part / name).lexically_normal(); !listed.contains(file))
        wrong[manifest.string()].push_back(fmt::format("{} is not in SHA256SUMS", file.string()));
  }
}

// Names a record that differs from another one of its folder, cell and build in more than timings.
void compare_doubles(std::vector<RecordIdentity> records, Wrong& wrong) {
  std::ranges::sort(records, {}, [](const RecordIdentity& record) {
    return std::tuple_cat(record.place(), std::tuple(std::string_view(record.file)));
  });
  for (std::size_t i = 1; i < records.size(); ++i) {
    const RecordIdentity &first = records[i - 1], &second = records[i];
    if (first.place() != second.place()) continue;
    try {
      Json record = read_json(first.file);
      const std::string difference = unite_records(record, read_json(second.file));
      if (!difference.empty())
        wrong[second.file].push_back(
            fmt::format("{} is of the same cell and build and differs at {}",
                        fs::path(first.file).filename().string(), difference));
    } catch (const std::exception& error) {
      wrong[second.file].push_back(
          fmt::format("it cannot be compared with {}: {}", first.file, reason_of(error)));
    }
  }
}

// Names a record whose noise level is not that of another one of its instance. A run without a loss
// at its start, such as that of an inapplicable method, states no noise level.
void compare_noise(const std::vector<RecordIdentity>& records, Wrong& wrong) {
  std::map<std::string, const RecordIdentity*> first;
  for (const RecordIdentity& record : records) {
    if (!record.has_started) continue;
    const RecordIdentity& other = *first.try_emplace(record.instance, &record).first->second;
    if (record.noise_level == other.noise_level) continue;
    wrong[record.file].push_back("its noise level is not that of the same instance in " +
                                 other.file);
  }
}

int run(const ValidateArguments& given, Session&) {
  Wrong wrong;
  const std::vector<std::string> files = files_under(given.paths, wrong);
  for (const std::string& path : given.paths) compare_with_manifest(path, wrong);
  std::vector<Examined> all(files.size());
  share(
      files.size(), [&](std::size_t i) { all[i] = examined(files[i]); },
      progress_on_terminal("files"));
  std::vector<RecordIdentity> records;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!all[i].violations.empty()) wrong[files[i]] = std::move(all[i].violations);
    if (all[i].identity) records.push_back(std::move(*all[i].identity));
  }
  compare_noise(records, wrong);
  compare_doubles(std::move(records), wrong);
  for (const auto& [file, violations] : wrong)
    for (const std::string& violation : violations)
      say(stdout, fmt::format("{}: {}\n", file, violation));
  say(stdout, fmt::format("{} checked, {} invalid\n", reports::counted(files.size(), "file"),
                          wrong.size()));
  return wrong.empty() ? kGood : kWorse;
}

}  // namespace

void register_validate(VerbRegistry& registry) {
  registry.add(verb_of<ValidateArguments>(
      {.name = "validate",
       .help_position = 235,
       .summary = "Check records, suites and Isoline's other JSON files against their schemas",
       .examples = "  isoline validate results/quick my-suite.json"},
      declare, run));
}

}  // namespace isoline::benchmarks
