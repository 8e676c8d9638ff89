// Reads the two sides of a comparison: result folders, a baseline, reports.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "reports/compare/baseline.h"
#include "reports/compare/folder_subjects.h"
#include "reports/compare/gate.h"
#include "reports/formats/formats.h"
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
  require(is_there(path), [&] {
    return fmt::format("{}: no such result folder, baseline or report", path.string());
  });
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

// Of the baselines in a folder, ordered by name; what is none is left out.
std::vector<Headline> headlines_in(const fs::path& folder) {
  std::vector<Headline> all;
  for (const fs::path name : names_in(folder)) try {
      if (name.extension() != ".json") continue;
      Baseline baseline = baseline_from_json(read_json(folder / name));
      baseline.headline.label = name.stem().string();
      all.push_back(std::move(baseline.headline));
    } catch (const UsageError&) {  // of a time before this schema
    }
  return all;
}

// Earlier baselines, the one compared with, and NEW.
void add_trend(GateResult& result, const GateOptions& options, Headline before, Headline after) {
  if (!options.earlier) return;
  result.trend = headlines_in(*options.earlier);
  before.label = "BASE";
  after.label = "NEW";
  result.trend.push_back(std::move(before));
  result.trend.push_back(std::move(after));
}

GateResult compare_reports(const Side& before, const Side& after, const GateOptions& options) {
  const auto subjects_in = [](const Side& side) {
    if (!side.is_folder()) return subjects_of_report(side.file);
    const Study study = read_study({side.path});
    return subjects_of_report(
        parse_json(json_report(document_of(compare_optimizers(study))), side.path.string()));
  };
  require(!options.earlier, "a trend is read off record folders and baselines, not off reports");
  GateResult result = compare_subjects(subjects_in(before), subjects_in(after), options);
  result.remarks.push_back("reports hold no repetitions: time is judged on record folders only");
  return result;
}

GateResult compare_with_baseline(const Side& before, const fs::path& after,
                                 const GateOptions& options) {
  const Baseline baseline = baseline_from_json(before.file);
  const FolderSubjects found = read_subjects(after, baseline.minima, options.listener);
  GateResult result = compare_subjects(baseline.subjects, found.subjects, options);
  add_trend(result, options, baseline.headline, headline_of("NEW", found.subjects));
  result.remarks.push_back("a baseline holds no times: none is judged");
  remark_on(found, after, result.remarks);
  return result;
}

GateResult compare_folders(const fs::path& before, const fs::path& after,
                           const GateOptions& options) {
  const FolderSubjects old = read_subjects(before, std::nullopt, options.listener);
  const FolderSubjects now = read_subjects(after, old.best, options.listener);
  GateResult result = compare_subjects(old.subjects, now.subjects, options);
  add_trend(result, options, headline_of("BASE", old.subjects), headline_of("NEW", now.subjects));
  remark_on(old, before, result.remarks);
  remark_on(now, after, result.remarks);
  return result;
}

}  // namespace

GateResult compare_results(const fs::path& before, const fs::path& after,
                           const GateOptions& options) {
  const Side old = side_of(before), now = side_of(after);
  if (old.is_baseline() || now.is_baseline()) {
    require(old.is_baseline() && now.is_folder(),
            "a baseline is compared with a result folder: isoline compare BASELINE RESULTS");
    return compare_with_baseline(old, after, options);
  }
  if (old.is_folder() && now.is_folder()) return compare_folders(before, after, options);
  return compare_reports(old, now, options);
}

}  // namespace isoline::reports
