// Reads the two sides of a comparison: result folders, or a baseline and a folder.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "reports/compare/baseline.h"
#include "reports/compare/folder_subjects.h"
#include "reports/compare/gate.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

namespace fs = std::filesystem;

struct Side {
  fs::path path;
  Json file;  // null of a result folder

  bool is_folder() const { return file.is_null(); }
  bool is_baseline() const {
    return file.is_object() && file.value("schema", "") == kBaselineSchema;
  }
};

Side side_of(const fs::path& path) {
  require(is_there(path),
          [&] { return fmt::format("{}: no such result folder or baseline", path.string()); });
  std::error_code unknown;
  return {path, fs::is_directory(path, unknown) ? Json() : read_json(path)};
}

void remark_on(const FolderSubjects& found, const fs::path& path,
               std::vector<std::string>& remarks) {
  if (found.unreadable > 0)
    remarks.push_back(fmt::format("{} of {} could not be read", counted(found.unreadable, "file"),
                                  path.string()));
  if (found.superseded > 0)
    remarks.push_back(fmt::format("{} of {} left aside for newer builds of the same cells",
                                  counted(found.superseded, "older record"), path.string()));
}

GateResult compare_with_baseline(const Side& before, const fs::path& after,
                                 const GateOptions& options) {
  const Baseline baseline = baseline_from_json(before.file);
  const FolderSubjects found = read_subjects(after, baseline.minima, options.listener);
  GateResult result = compare_subjects(baseline.subjects, found.subjects, options);
  result.remarks.push_back("a baseline holds no times: none is judged");
  remark_on(found, after, result.remarks);
  return result;
}

GateResult compare_folders(const fs::path& before, const fs::path& after,
                           const GateOptions& options) {
  const FolderSubjects old = read_subjects(before, std::nullopt, options.listener);
  const FolderSubjects now = read_subjects(after, old.best, options.listener);
  GateResult result = compare_subjects(old.subjects, now.subjects, options);
  remark_on(old, before, result.remarks);
  remark_on(now, after, result.remarks);
  return result;
}

}  // namespace

GateResult compare_results(const fs::path& before, const fs::path& after,
                           const GateOptions& options) {
  const Side old = side_of(before), now = side_of(after);
  require(now.is_folder() && (old.is_folder() || old.is_baseline()),
          "compare takes two result folders, or a baseline and a result folder: "
          "isoline compare BASE RESULTS");
  return old.is_baseline() ? compare_with_baseline(old, after, options)
                           : compare_folders(before, after, options);
}

}  // namespace isoline::reports
