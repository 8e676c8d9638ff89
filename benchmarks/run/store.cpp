// The result folder on disk.
#include "benchmarks/run/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/build_parts.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

fs::path run_path(const fs::path& folder, const std::string& file_name) {
  return folder / "runs" / file_name;
}

// A file half written by a process that was killed: its name ends in ".PID.tmp".
bool is_abandoned(const fs::path& path) {
  if (path.extension() != ".tmp") return false;
  const std::string pid = path.stem().extension().string();  // ".PID", or empty
  const int writer = pid.empty() ? 0 : std::atoi(pid.c_str() + 1);
  return writer <= 0 || (kill(writer, 0) != 0 && errno == ESRCH);
}

// Held while the plan is read and written: two runs may share a folder.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    flock(descriptor_, LOCK_EX);
  }
  ~FolderLock() { close(descriptor_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace

Store::Store(fs::path folder) : folder_(std::move(folder)) {
  make_folders();
  for (const auto& entry : fs::recursive_directory_iterator(folder_))
    if (is_abandoned(entry.path())) fs::remove(entry.path());
}

std::string Store::name_of(const Request& request) {
  return record_file_name(request.cell, build_digest(request));
}

bool Store::has(const Request& request) const {
  std::error_code unreadable;
  return fs::exists(run_path(folder_, name_of(request)), unreadable);
}

void Store::make_folders() const {
  for (const char* part : {"runs", "components", "checkpoints"}) {
    std::error_code error;
    fs::create_directories(folder_ / part, error);
    require(!error, [&] {
      return fmt::format("cannot create {}: {}", (folder_ / part).string(), error.message());
    });
  }
}

void Store::plan(const std::string& suite, const std::vector<PlannedCell>& cells) {
  const FolderLock lock(folder_);
  Plan plan;
  const fs::path path = folder_ / "plan.json";
  if (fs::exists(path)) plan = plan_from_text(read_text(path), path.string());
  if (std::ranges::find(plan.suites, suite) == plan.suites.end()) plan.suites.push_back(suite);
  std::set<std::string> known;
  for (const PlannedCell& cell : plan.cells) known.insert(cell.cell);
  for (const PlannedCell& cell : cells)
    if (known.insert(cell.cell).second) plan.cells.push_back(cell);
  write_text(path, to_json(plan).dump() + "\n");
}

std::optional<Record> Store::find_in(const fs::path& folder, const Request& request) {
  const fs::path path = run_path(folder, name_of(request));
  if (!fs::exists(path)) return std::nullopt;
  try {
    Record record = read_record(path);
    if (record.status == Status::interrupted) return std::nullopt;
    return record;
  } catch (const UsageError&) {
    return std::nullopt;  // damaged: the cell is run again and the file replaced
  }
}

RecordsOfAnyBuild::RecordsOfAnyBuild(const fs::path& folder) {
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder / "runs", missing)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".json")
      paths_[name.substr(0, name.find('-'))].push_back(entry);
  }
}

std::optional<Record> RecordsOfAnyBuild::find(const Request& request) const {
  const auto paths = paths_.find(request.cell);
  if (paths == paths_.end()) return std::nullopt;
  std::optional<Record> newest;
  for (const fs::path& path : paths->second) {
    try {
      Record record = read_record(path);
      if (is_failure(record.status) || record.is_nondeterministic) continue;
      if (!newest || newest->provenance.run.started < record.provenance.run.started)
        newest = std::move(record);
    } catch (const UsageError&) {
      continue;  // damaged
    }
  }
  return newest;
}

void Store::write(Record record, const std::optional<Record>& earlier) {
  if (earlier) {
    auto& times = record.repeat_wall_seconds;
    times.insert(times.end(), earlier->repeat_wall_seconds.begin(),
                 earlier->repeat_wall_seconds.end());
    std::ranges::sort(times);
  }
  try {
    write_files(record);
  } catch (const std::exception&) {
    std::error_code unknown;
    if (fs::is_directory(folder_ / "runs", unknown)) throw;
    make_folders();  // they were removed while the run goes on
    write_files(record);
  }
}

void Store::write_files(const Record& record) const {
  const fs::path path = run_path(folder_, record.file_name());
  if (record.exhibit && record.exhibit->is_picture())
    write_pictures(*record.exhibit, fs::path(path).replace_extension(".npy"));
  write_text(path, to_json(record).dump() + "\n");
}

fs::path Store::checkpoint_path(const Request& request) const {
  return folder_ / "checkpoints" / fs::path(name_of(request)).replace_extension(".state");
}

void Store::remove_checkpoint(const Request& request) const {
  std::error_code missing;
  fs::remove(checkpoint_path(request), missing);
}

void Store::write(const Sheet& sheet) {
  write_text(folder_ / "components" / sheet.file_name(), to_json(sheet).dump() + "\n");
}

}  // namespace isoline::benchmarks
