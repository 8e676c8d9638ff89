// Reads result folders. Records come by the ten thousand, and parsing them is nearly all the time a
// report takes, so threads share the files.
#include "reports/read/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <unordered_map>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"

namespace isoline::reports {
namespace {

namespace fs = std::filesystem;

// Which stand there under such a name, whatever they are; where that cannot be told, why.
std::vector<fs::path> json_files(const fs::path& folder, std::vector<Unreadable>& unreadable) {
  std::vector<fs::path> files;
  try {
    for (const std::string& name : names_in(folder))
      if (name.ends_with(".json")) files.push_back(folder / name);
  } catch (const UsageError& error) {
    unreadable.push_back({folder, error.what()});
  }
  return files;
}

// The record, or why it is none.
std::string read_into(Record& record, const fs::path& file) {
  try {
    record = read_record(file);
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

const std::string& started(const Record& record) { return record.provenance.run.started; }

// ISO times sort as text; the file name decides where they are absent or equal.
bool is_newer(const Record& a, const Record& b) {
  return std::pair(started(a), a.file_name()) > std::pair(started(b), b.file_name());
}

// Where the record of each cell stands among the `kept` first ones of all.
using Places = std::unordered_map<std::string, std::size_t>;

// What no clock decides is the same in all records of one build.
bool are_at_odds(const Record& a, const Record& b) {
  return a.build == b.build && !a.is_nondeterministic && !b.is_nondeterministic &&
         result_of(to_json(a)) != result_of(to_json(b));
}

void keep_newest(Study& study, Places& place, std::size_t index) {
  Record& record = study.runs[index];
  const std::size_t kept = place.size();
  const auto [at, is_first] = place.emplace(record.cell, kept);
  Record& known = study.runs[at->second];
  if (!is_first) ++study.superseded;
  if (!is_first && are_at_odds(record, known)) study.disputed.insert(record.cell);
  if (&known != &record && (is_first || is_newer(record, known))) known = std::move(record);
}

void read_runs(Study& study, const std::vector<std::string>& folders, const Listener& listener) {
  std::vector<fs::path> files;
  for (const fs::path folder : folders)
    for (fs::path& file : json_files(folder / "runs", study.unreadable))
      files.push_back(std::move(file));
  std::vector<std::string> reasons(files.size());
  study.runs.resize(files.size());
  share(
      files.size(), [&](std::size_t i) { reasons[i] = read_into(study.runs[i], files[i]); },
      listener);
  Places place;
  for (std::size_t i = 0; i < files.size(); ++i)
    if (reasons[i].empty())
      keep_newest(study, place, i);
    else
      study.unreadable.push_back({files[i], std::move(reasons[i])});
  study.runs.resize(place.size());
  const auto order = [](const Record& r) {
    return std::tie(r.request.problem.spec, r.request.optimizer.spec, r.request.seed, r.cell);
  };
  std::sort(study.runs.begin(), study.runs.end(),
            [&](const Record& a, const Record& b) { return order(a) < order(b); });
}

void read_sheets(Study& study, const fs::path& folder, std::set<std::string>& known) {
  for (const fs::path& file : json_files(folder / "components", study.unreadable)) try {
      Sheet sheet = sheet_from_text(read_text(file), file.string());
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

std::optional<Exhibit> Study::pictures_of(const Record& record) const {
  Exhibit exhibit = *record.exhibit;
  for (const fs::path folder : folders) {
    const fs::path file = (folder / "runs" / record.file_name()).replace_extension(".npy");
    if (is_there(file)) try {
        read_pictures(exhibit, file);
        return exhibit;
      } catch (const std::exception&) {
        return std::nullopt;
      }
  }
  return std::nullopt;
}

Study read_study(const std::vector<std::string>& folders, const Listener& listener) {
  std::error_code unknown;
  for (const fs::path folder : folders)
    require(fs::is_directory(folder, unknown),
            [&] { return "no result folder " + folder.string(); });
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
