// Reads rows of tables of rates.
#include "core/results/study.h"

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
#include "core/records/json_view.h"
#include "core/results/statistics.h"

namespace isoline::results {
namespace {

std::string text_at(const JsonView& row, const char* key) {
  return row.contains(key) ? row.at(key).get<std::string>() : "";
}

void read_grid(const JsonView& source, TunedRate& rate) {
  const auto options = source.at("grid").items();
  if (options.empty()) return;
  rate.option = options.front().first;
  rate.values = reals_of(options.front().second);
  if (source.contains("score"))
    for (const JsonView& score : source.at("score").values())
      rate.work.push_back(real_of(score.values().at(0)));
  require(rate.work.empty() || rate.work.size() == rate.values.size(),
          "a grid of rates lacks the score of a value");
}

TunedRate rate_from(const JsonView& row) {
  TunedRate rate{.problem = row.at("problem"),
                 .optimizer = row.at("optimizer"),
                 .file = text_at(row, "file"),
                 .paper = {},
                 .option = {},
                 .values = {},
                 .work = {}};
  const JsonView source = row.at("source");
  rate.paper = text_at(source, "paper");
  if (source.contains("grid")) read_grid(source, rate);
  if (source.contains("edge")) source.at("edge").get_to(rate.is_at_edge);
  return rate;
}

}  // namespace

bool TunedRate::is_ever_solved() const {
  return std::ranges::any_of(work, [](Real each) { return each < kNever; });
}

std::vector<TunedRate> rates_from_text(const std::string& text, const std::string& origin) {
  JsonReader reader;
  std::vector<TunedRate> rates;
  for (const JsonView& row : reader.parse(text, origin).at("rows").values())
    rates.push_back(rate_from(row));
  return rates;
}

std::vector<TunedRate> read_rates(const std::string& folder) {
  const std::filesystem::path file = std::filesystem::path(folder) / "rates.json";
  if (!is_there(file)) return {};
  return rates_from_text(read_text(file), file.string());
}

// Reads result folders. Records come by the ten thousand, and parsing them is nearly all the time a
// report takes, so threads share the files.

namespace {

namespace fs = std::filesystem;

// The record, or the reason why it is invalid.
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

// Chooses among the records of each cell.

namespace {

// ISO times sort as text; the file name decides where they are absent or equal.
bool is_newer(const RunMark& a, const RunMark& b) {
  return std::pair(a.started, record_file_name(a.cell, a.build)) >
         std::pair(b.started, record_file_name(b.cell, b.build));
}

// Everything that no clock decides is equal in all records of one build.
bool should_agree(const RunMark& a, const RunMark& b) {
  return a.build == b.build && !a.is_nondeterministic && !b.is_nondeterministic;
}

}  // namespace

RunMark mark_of(const Record& record) {
  return {.cell = record.cell,
          .build = record.build,
          .started = record.provenance.run.started,
          .problem = record.request.problem.spec,
          .optimizer = record.request.optimizer.spec,
          .seed = record.request.seed,
          .is_nondeterministic = record.is_nondeterministic};
}

Newest newest_of(const std::vector<RunMark>& marks,
                 const std::function<bool(std::size_t, std::size_t)>& are_at_odds) {
  Newest newest;
  std::unordered_map<std::string_view, std::size_t> known;  // by cell, its newest so far
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i].cell.empty()) continue;
    const auto [at, is_first] = known.emplace(marks[i].cell, i);
    if (is_first) continue;
    ++newest.superseded;
    if (should_agree(marks[i], marks[at->second]) && are_at_odds(i, at->second))
      newest.disputed.insert(marks[i].cell);
    if (is_newer(marks[i], marks[at->second])) at->second = i;
  }
  for (const auto& [cell, i] : known) newest.kept.push_back(i);
  std::ranges::sort(newest.kept, {}, [&](std::size_t i) {
    return std::tie(marks[i].problem, marks[i].optimizer, marks[i].seed, marks[i].cell);
  });
  return newest;
}

bool are_at_odds(const Record& a, const Record& b) {
  return result_of(to_json(a)) != result_of(to_json(b));
}

// Lists result folders.

std::vector<std::string> json_files(const std::filesystem::path& folder,
                                    std::vector<Unreadable>& unreadable) {
  std::vector<std::string> files;
  try {
    for (const std::string& name : names_in(folder))
      if (name.ends_with(".json")) files.push_back((folder / name).string());
  } catch (const UsageError& error) {
    unreadable.push_back({folder.string(), error.what()});
  }
  return files;
}

std::vector<std::string> record_files(const std::vector<std::string>& folders,
                                      std::vector<Unreadable>& unreadable) {
  std::vector<std::string> all;
  for (const std::filesystem::path folder : folders)
    for (std::string& file : json_files(folder / "runs", unreadable))
      all.push_back(std::move(file));
  return all;
}

}  // namespace isoline::results
