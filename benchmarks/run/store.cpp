// The result folder on disk.
#include "benchmarks/run/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "benchmarks/plan/build_parts.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/request.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

fs::path run_path(const fs::path& folder, const std::string& file_name) {
  return folder / "runs" / file_name;
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
  sweep();
}

std::string Store::name_of(const Request& request) {
  return record_file_name(request.cell, build_digest(request));
}

bool Store::has(const Request& request) const {
  return is_there(run_path(folder_, name_of(request)));
}

void Store::make_folders() const {
  for (const char* part : {"runs", "components", "checkpoints", ""}) {
    std::error_code error;
    fs::create_directories(folder_ / part, error);
    require(!error, [&] {
      return fmt::format("cannot create {}: {}", (folder_ / part).string(), error.message());
    });
    // Said before anything runs: a disk may be there to be read only.
    require(::access((folder_ / part).c_str(), W_OK) == 0, [&] {
      return fmt::format("cannot write to {}: {}", (folder_ / part).string(), strerror(errno));
    });
  }
}

// Removes only what our own writing leaves behind; all other files belong to someone.
void Store::sweep() const {
  for (const char* part : {"", "runs", "components", "checkpoints"})
    for (const std::string& name : names_in(folder_ / part))
      if (const fs::path path = folder_ / part / name; is_abandoned(path)) {
        std::error_code error;
        fs::remove(path, error);
      }
}

void Store::set_aside(const fs::path& path, const std::string& reason) {
  const std::string name = path.string();
  const bool is_named = reason.find(name) != std::string::npos;
  const std::string sentence = is_named ? reason : fmt::format("{}: {}", name, reason);
  try {
    remark(fmt::format("damaged: {}; moved to {}", sentence,
                       move_into(folder_ / "damaged", path).string()));
  } catch (const UsageError& error) {
    remark(fmt::format("damaged: {}; {}", sentence, error.what()));
  }
}

void Store::clear_way(const fs::path& path) {
  std::error_code unknown;
  switch (fs::symlink_status(path, unknown).type()) {
    case fs::file_type::none:
    case fs::file_type::not_found:
    case fs::file_type::regular:
    case fs::file_type::symlink:
      return;  // writing replaces it
    default:
      set_aside(path, "it is not a file");
  }
}

void Store::plan(const std::string& suite, const std::vector<PlannedCell>& cells) {
  const FolderLock lock(folder_);
  Plan plan;
  const fs::path path = folder_ / "plan.json";
  if (is_there(path)) try {
      plan = plan_from_text(read_text(path), path.string());
    } catch (const std::exception& error) {
      plan = {};
      set_aside(path, fmt::format("{} (of the cells planned by earlier runs, only those with a "
                                  "record are known)",
                                  error.what()));
    }
  if (std::ranges::find(plan.suites, suite) == plan.suites.end()) plan.suites.push_back(suite);
  std::set<std::string> known;
  for (const PlannedCell& cell : plan.cells) known.insert(cell.cell);
  for (const PlannedCell& cell : cells)
    if (known.insert(cell.cell).second) plan.cells.push_back(cell);
  write_text(path, file_text(plan));
}

namespace {

// Nothing if the file does not exist; throws if it is not the record of the request.
std::optional<Record> stored_record(const fs::path& path, const Request& request) {
  if (!is_there(path)) return std::nullopt;
  Record record = read_record(path);
  require(record.cell == request.cell,
          [&] { return "it is the record of another cell, " + record.cell; });
  if (record.status == Status::interrupted) return std::nullopt;
  return record;
}

}  // namespace

std::optional<Record> Store::find(const Request& request) {
  const fs::path path = run_path(folder_, name_of(request));
  try {
    return stored_record(path, request);
  } catch (const std::exception& error) {
    set_aside(path, error.what());
    return std::nullopt;
  }
}

std::optional<Record> Store::find_in(const fs::path& folder, const Request& request) {
  try {
    return stored_record(run_path(folder, name_of(request)), request);
  } catch (const std::exception&) {
    return std::nullopt;  // damaged: a run sets it aside
  }
}

RecordsOfAnyBuild::RecordsOfAnyBuild(const fs::path& folder) {
  for (const std::string& name : names_in(folder / "runs"))
    if (name.ends_with(".json"))
      paths_[name.substr(0, name.find('-'))].push_back(folder / "runs" / name);
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
    } catch (const std::exception&) {
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
  try_to_write([&] { write_files(record); });
}

void Store::try_to_write(const std::function<void()>& write) {
  constexpr int kTries = 3;
  for (int i = 1;; ++i) {
    try {
      return write();
    } catch (const std::exception&) {
      if (i == kTries) throw;
      make_folders();
    }
  }
}

void Store::write_files(const Record& record) {
  const fs::path path = run_path(folder_, record.file_name());
  const fs::path fields = field_path(path);
  if (record.fields && !record.fields->numbers.empty()) {
    clear_way(fields);
    write_text(fields, field_file(*record.fields));
  }
  clear_way(path);
  write_text(path, file_text(record));
  std::error_code unknown;
  if (!record.fields) fs::remove(fields, unknown);  // of an earlier run that kept them
}

fs::path Store::checkpoint_path(const Request& request) const {
  return folder_ / "checkpoints" / fs::path(name_of(request)).replace_extension(".state");
}

void Store::remove_checkpoint(const Request& request) const {
  std::error_code missing;
  fs::remove(checkpoint_path(request), missing);
}

void Store::write(const Sheet& sheet) {
  const fs::path path = folder_ / "components" / sheet.file_name();
  try_to_write([&] {
    clear_way(path);
    write_text(path, file_text(sheet));
  });
}

}  // namespace isoline::benchmarks
