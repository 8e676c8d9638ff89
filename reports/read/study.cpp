// Reads result folders. Records come by the ten thousand, and parsing them is nearly all the time a
// report takes, so threads share the files.
#include "reports/read/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "reports/read/newest.h"
#include "reports/read/result_files.h"

namespace isoline::reports {
namespace {

namespace fs = std::filesystem;

// The record, or why it is none.
std::string read_into(Record& record, const std::string& file) {
  try {
    record = read_record(file);
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

void read_runs(Study& study, const std::vector<std::string>& folders, const Listener& listener) {
  const std::vector<std::string> files = record_files(folders, study.unreadable);
  std::vector<std::string> reasons(files.size());
  std::vector<Record> runs(files.size());
  share(
      files.size(), [&](std::size_t i) { reasons[i] = read_into(runs[i], files[i]); }, listener);
  std::vector<RunMark> marks(files.size());
  for (std::size_t i = 0; i < files.size(); ++i)
    if (reasons[i].empty())
      marks[i] = mark_of(runs[i]);
    else
      study.unreadable.push_back({files[i], std::move(reasons[i])});
  Newest newest =
      newest_of(marks, [&](std::size_t i, std::size_t j) { return are_at_odds(runs[i], runs[j]); });
  for (const std::size_t i : newest.kept) study.runs.push_back(std::move(runs[i]));
  study.superseded = newest.superseded;
  study.disputed = std::move(newest.disputed);
}

void read_sheets(Study& study, const fs::path& folder, std::set<std::string>& known) {
  for (const std::string& file : json_files(folder / "components", study.unreadable)) try {
      Sheet sheet = sheet_from_text(read_text(file), file);
      if (known.insert(sheet.file_name()).second) study.sheets.push_back(std::move(sheet));
    } catch (const std::exception& error) {
      study.unreadable.push_back({file, error.what()});
    }
}

void read_plan(Study& study, const fs::path& folder, std::set<std::string>& known) {
  const fs::path file = folder / "plan.json";
  if (is_there(file)) try {
      Plan plan = plan_from_text(read_text(file), file.string());
      for (std::string& suite : plan.suites)
        if (std::ranges::find(study.plan.suites, suite) == study.plan.suites.end())
          study.plan.suites.push_back(std::move(suite));
      for (PlannedCell& cell : plan.cells)
        if (known.insert(cell.cell).second) study.plan.cells.push_back(std::move(cell));
    } catch (const std::exception& error) {
      study.unreadable.push_back({file, error.what()});
    }
}

void read_audit(Study& study, const fs::path& folder) {
  const fs::path file = folder / "audit.json";
  if (is_there(file)) try {
      for (AuditedOptimizer& audited : audit_from_json(read_json(file)))
        if (std::ranges::find(study.audits, audited.name, &AuditedOptimizer::name) ==
            study.audits.end())
          study.audits.push_back(std::move(audited));
    } catch (const std::exception& error) {
      study.unreadable.push_back({file, error.what()});
    }
}

void read_rates_of(Study& study, const fs::path& folder) {
  try {
    for (TunedRate& rate : read_rates(folder)) study.rates.push_back(std::move(rate));
  } catch (const std::exception& error) {
    study.unreadable.push_back({folder / "rates.json", error.what()});
  }
}

}  // namespace

std::optional<FieldFrames> Study::fields_of(const Record& record) const {
  const bool is_older = record.exhibit && record.exhibit->is_picture();
  if (!record.fields && !is_older) return std::nullopt;
  for (const fs::path folder : folders) {
    const fs::path file = field_path(folder / "runs" / record.file_name());
    if (is_there(file)) try {
        if (!record.fields) return frames_of(*record.exhibit, record.summary.iterations, file);
        FieldFrames frames = *record.fields;
        read_field_numbers(frames, file);
        return frames;
      } catch (const std::exception&) {
        continue;  // another folder may have it whole
      }
  }
  return std::nullopt;
}

Study read_study(const std::vector<std::string>& folders, const Listener& listener) {
  std::error_code unknown;
  for (const fs::path folder : folders) {
    require(!fs::is_regular_file(folder, unknown), [&] {
      return folder.string() +
             " is a file, not a result folder: unpack an archive first, with tar -xf";
    });
    require(fs::is_directory(folder, unknown),
            [&] { return folder.string() + ": no such result folder"; });
  }
  Study study;
  study.folders = folders;
  std::set<std::string> cells, sheets;
  for (const fs::path folder : folders) {
    read_plan(study, folder, cells);
    read_sheets(study, folder, sheets);
    read_audit(study, folder);
    read_rates_of(study, folder);
  }
  std::ranges::sort(study.audits, {}, &AuditedOptimizer::name);
  read_runs(study, folders, listener);
  return study;
}

}  // namespace isoline::reports
