// The result folder on disk: its files, its locks, and the comparison of two of its records. A
// POSIX lock belongs to the process, not to the open file.
#include "benchmarks/run/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "benchmarks/plan/catalog.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/output.h"
#include "core/records/json_view.h"
#include "core/records/request.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

fs::path run_path(const fs::path& folder, const std::string& file_name) {
  return folder / "runs" / file_name;
}

// Held while the plan is read and written: two runs may share a folder.
struct FolderLock {
  explicit FolderLock(const fs::path& folder)
      : descriptor(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    flock(descriptor, LOCK_EX);
  }
  ~FolderLock() { close(descriptor); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  const int descriptor;
};

constexpr const char* kParts[] = {"runs", "components", "checkpoints", ""};

// Nothing if the file does not exist; throws if it is not the record of the request.
std::optional<Record> stored_record(const fs::path& path, const Request& request) {
  if (!is_there(path)) return std::nullopt;
  Record record = read_record(path);
  require(record.cell == request.cell,
          [&] { return "it is the record of another cell, " + record.cell; });
  if (record.status == Status::interrupted) return std::nullopt;
  return record;
}

// One flush for them all, which takes as long as that of one file: none gets its name before all
// are whole.
void write_together(const std::vector<std::pair<fs::path, std::string>>& files) {
  if (files.size() == 1) return write_text(files[0].first, files[0].second);
  try {
    for (const auto& [path, text] : files) write_unflushed(temporary_of(path), text);
    flush_all(files[0].first.parent_path());
    for (const auto& [path, text] : files) fs::rename(temporary_of(path), path);
  } catch (...) {
    for (const auto& [path, text] : files) ::unlink(temporary_of(path).c_str());
    throw;
  }
}

// --- locks

bool lock(int descriptor, short kind, const std::string& cell) {
  const auto place =
      static_cast<off_t>(fnv1a(cell) >> 2);  // not negative, with space for the length
  struct flock one {
    .l_type = kind, .l_whence = SEEK_SET, .l_start = place, .l_len = 1, .l_pid = 0
  };
  while (fcntl(descriptor, F_SETLK, &one) != 0) {
    if (errno == EACCES || errno == EAGAIN) return false;
    if (errno != EINTR) break;  // no locks here
  }
  return true;
}

// The locks within [begin, end), each a byte, counted by asking for one and then on either side.
std::size_t locks_between(int descriptor, off_t begin, off_t end) {
  if (begin >= end) return 0;
  struct flock one {
    .l_type = F_RDLCK, .l_whence = SEEK_SET, .l_start = begin, .l_len = end - begin, .l_pid = 0
  };
  if (fcntl(descriptor, F_GETLK, &one) != 0 || one.l_type == F_UNLCK) return 0;
  if (one.l_start < begin || one.l_start >= end) return 0;  // not one of our locks
  return 1 + locks_between(descriptor, begin, one.l_start) +
         locks_between(descriptor, one.l_start + 1, end);
}

// --- two records of one cell, as they stand in JSON: their curves by iteration, then the rest

std::string shown(const Json& value) {
  constexpr std::size_t kMost = 60;
  const std::string text = json_text(value);
  return text.size() <= kMost ? text : std::string(cut(text, kMost)) + "…";
}

// The value at a place of a record, or a note that it is missing.
Json value_at(const Json& json, const Json::json_pointer& place) {
  return json.contains(place) ? json.at(place) : Json("nothing");
}

std::string against(const std::string& name, const Json::json_pointer& place, const Json& a,
                    const Json& b) {
  return fmt::format("{}: {} against {}", name, shown(value_at(a, place)),
                     shown(value_at(b, place)));
}

// The earliest of the first `points` entries of all columns of two curves in which they differ.
std::string difference_in_curves(const Json& a, const Json& b, std::size_t points) {
  const Json columns[] = {a.flatten(), b.flatten()};  // by "/counts/forward/17"
  std::string difference;
  std::size_t first = points;
  for (const Json& some : columns)
    for (const auto& [path, value] : some.items()) {
      if (value.is_null()) continue;  // a column without entries
      const Json::json_pointer place(path);
      const std::size_t i = std::stoul(place.back());
      if (i >= first || (json_text(value_at(a, place)) == json_text(value_at(b, place)))) continue;
      first = i;
      std::string column = place.parent_pointer().to_string().substr(1);
      std::ranges::replace(column, '/', ' ');
      std::ranges::replace(column, '_', ' ');
      column += " at iteration " + shown(a.at("iteration").at(i));
      difference = against(column, place, a, b);
    }
  return difference;
}

// For spectra, at an iteration where both records have one; then for fields.
std::string difference_in_what_is_kept(const Record& a, const Record& b) {
  if (a.spectrum && b.spectrum)
    for (std::size_t i = 0; i < a.spectrum->iterations.size(); ++i) {
      const auto& others = b.spectrum->iterations;
      const auto there = std::ranges::find(others, a.spectrum->iterations[i]);
      if (there != others.end() &&
          a.spectrum->sigma[i] !=
              b.spectrum->sigma[static_cast<std::size_t>(there - others.begin())])
        return fmt::format("singular values at iteration {}", *there);
    }
  if (!a.fields || !b.fields || *a.fields == *b.fields) return "";
  if (a.fields->iterations != b.fields->iterations) return "iterations of the fields";
  return fmt::format("fields: {} against {}", a.fields->digest, b.fields->digest);
}

}  // namespace

// Removes what killed runs of this machine left half-written; all other files belong to someone.
Store::Store(fs::path folder) : folder_(std::move(folder)) {
  make_folders();
  for (const char* part : kParts)
    for (const std::string& name : names_in(folder_ / part))
      if (const fs::path path = folder_ / part / name; is_abandoned(path)) {
        std::error_code error;
        fs::remove(path, error);
      }
}

std::string Store::name_of(const Request& request) {
  return record_file_name(request.cell, build_digest(request));
}

bool Store::has(const Request& request) const {
  return is_there(run_path(folder_, name_of(request)));
}

void Store::make_folders() const {
  for (const char* part : kParts) make_output_folder(folder_ / part);
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

bool Store::clear_way(const fs::path& path) {
  std::error_code unknown;
  const fs::file_type type = fs::symlink_status(path, unknown).type();
  if (type == fs::file_type::none || type == fs::file_type::not_found) return false;
  if (type != fs::file_type::regular && type != fs::file_type::symlink)
    set_aside(path, "it is not a file");
  return true;  // writing replaces what is left
}

void Store::plan(const std::string& suite, const std::vector<PlannedCell>& cells) {
  const FolderLock lock(folder_);
  Plan plan;
  const fs::path path = folder_ / "plan.json";
  if (is_there(path)) try {
      plan = plan_from_text(read_text(path), path.string());
    } catch (const AccessError&) {
      throw;
    } catch (const std::exception& error) {
      plan = {};
      set_aside(path, fmt::format("{} (of the cells planned by earlier runs, only those with a "
                                  "record are known)",
                                  reason_of(error)));
    }
  add_suite(plan.suites, suite);
  std::set<std::string> known;
  for (const PlannedCell& cell : plan.cells) known.insert(cell.cell);
  for (const PlannedCell& cell : cells)
    if (known.insert(cell.cell).second) plan.cells.push_back(cell);
  write_text(path, file_text(plan));
}

std::optional<Record> Store::find(const Request& request) {
  const fs::path path = run_path(folder_, name_of(request));
  if (std::ranges::any_of(waiting_, [&](const auto& file) { return file.first == path; })) flush();
  try {
    return stored_record(path, request);
  } catch (const AccessError&) {  // it may be sound
    throw;
  } catch (const std::exception& error) {
    set_aside(path, reason_of(error));
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
    } catch (const std::exception& error) {
      say(stderr,
          fmt::format("left out: {}: {}\n", path.string(), reason_without(path.string(), error)));
    }
  }
  return newest;
}

void Store::keep(Record record, const std::optional<Record>& earlier) {
  if (earlier) {
    auto& times = record.repeat_wall_seconds;
    times.insert(times.end(), earlier->repeat_wall_seconds.begin(),
                 earlier->repeat_wall_seconds.end());
    std::ranges::sort(times);
  }
  const fs::path path = run_path(folder_, record.file_name());
  if (record.fields && !record.fields->numbers.empty())
    waiting_.emplace_back(field_path(path), field_file(*record.fields));
  if (record.answer && record.answer->is_in_file() && !record.answer->x.empty())
    waiting_.emplace_back(answer_path(path), answer_file(*record.answer));
  waiting_.emplace_back(path, file_text(record));  // after what it names
  if (!record.fields) obsolete_.insert(field_path(path));
}

void Store::flush() {
  if (waiting_.empty()) return;
  try_to_write([&] {
    for (const auto& [path, text] : waiting_)
      if (!clear_way(path)) obsolete_.erase(field_path(path));  // no earlier record
    write_together(waiting_);
  });
  for (const fs::path& path : std::exchange(obsolete_, {})) ::unlink(path.c_str());
  waiting_.clear();
}

void Store::write(Record record, const std::optional<Record>& earlier) {
  keep(std::move(record), earlier);
  flush();
}

void Store::remove(const Request& request) const {
  ::unlink(run_path(folder_, name_of(request)).c_str());
}

void Store::try_to_write(const std::function<void()>& write) {
  constexpr int kTries = 6;  // somebody may remove the folder again and again
  for (int i = 1;; ++i) {
    try {
      if (i > 1) make_folders();
      return write();
    } catch (const std::exception&) {
      if (i == kTries) throw;
    }
  }
}

fs::path Store::checkpoint_path(const Request& request) const {
  return folder_ / "checkpoints" / fs::path(name_of(request)).replace_extension(".state");
}

void Store::remove_checkpoint(const Request& request) const {
  std::error_code missing;
  fs::remove(checkpoint_path(request), missing);
}

void Store::look_for_states() {
  states_.clear();
  try {
    for (std::string& name : names_in(folder_ / "checkpoints"))
      if (name.ends_with(".state") || name.ends_with(".end")) states_.insert(std::move(name));
  } catch (const UsageError&) {  // cells start at their beginning
  }
}

fs::path Store::end_stem(const Request& request) const {
  Request any = request;
  any.budget.iterations = any.budget.work = 0;
  return folder_ / "checkpoints" / fs::path(name_of(named(std::move(any)))).stem();
}

fs::path Store::end_path(const fs::path& stem, const Budget& needed) {
  return stem.string() + fmt::format("-{}-{}.end", needed.iterations, needed.work);
}

fs::path Store::end_within_budget(const Request& request) const {
  if (states_.empty()) return {};
  Budget latest{.iterations = 0};
  const fs::path stem = end_stem(request);
  const std::string start = stem.filename().string() + "-";
  for (auto name = states_.lower_bound(start); name != states_.end() && name->starts_with(start);
       ++name) {
    Budget needed;
    if (std::sscanf(name->c_str() + start.size(), "%" SCNd64 "-%" SCNd64, &needed.iterations,
                    &needed.work) == 2 &&
        needed.iterations <= request.budget.iterations && needed.work <= request.budget.work &&
        needed.iterations > latest.iterations)
      latest = needed;
  }
  return latest.iterations > 0 ? end_path(stem, latest) : fs::path();
}

void Store::write(const Sheet& sheet) {
  const fs::path path = folder_ / "components" / sheet.file_name();
  try_to_write([&] {
    clear_way(path);
    write_text(path, file_text(sheet));
  });
}

Holds::Holds(const std::filesystem::path& folder)
    : descriptor_(open((folder / "cells.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  require(descriptor_ >= 0, [&] {
    return fmt::format("cannot write in {}: {}", folder.string(), std::strerror(errno));
  });
}

Holds::~Holds() { close(descriptor_); }

bool Holds::take(const std::string& cell) { return lock(descriptor_, F_WRLCK, cell); }

void Holds::release(const std::string& cell) { lock(descriptor_, F_UNLCK, cell); }

std::size_t held_cells(const std::filesystem::path& folder) {
  const int descriptor = open((folder / "cells.lock").c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return 0;
  const std::size_t count = locks_between(descriptor, 0, std::numeric_limits<off_t>::max());
  close(descriptor);
  return count;
}

bool same_result(const Record& a, const Record& b) {
  Json left = without_timings(to_json(a)), right = without_timings(to_json(b));
  left.erase("provenance");
  right.erase("provenance");
  return left == right && difference_in_what_is_kept(a, b).empty();
}

Comparison compare_results(const Record& a, const Record& b) {
  Comparison found{.is_up_to_there = a.is_nondeterministic || b.is_nondeterministic};
  const auto &of_a = a.curve.iteration, &of_b = b.curve.iteration;
  std::size_t points = std::min(of_a.size(), of_b.size());
  // The last point of a run that was ended is where it was ended.
  const std::int64_t end = points > 0 ? std::min(of_a.back(), of_b.back()) : 0;
  while (found.is_up_to_there && points > 0 && std::max(of_a[points - 1], of_b[points - 1]) >= end)
    --points;
  if (points > 0) found.iterations = of_a[points - 1];
  Json left = result_of(to_json(a)), right = result_of(to_json(b));
  found.difference = difference_in_curves(left.at("curve"), right.at("curve"), points);
  if (!found.difference.empty() || found.is_up_to_there) return found;
  if (of_a.size() != of_b.size()) {
    found.difference =
        fmt::format("last iteration: {} against {}", a.summary.iterations, b.summary.iterations);
    return found;
  }
  for (Json* rest : {&left, &right})  // what another build names otherwise
    for (const char* name : {"curve", "build", "build_parts"}) rest->erase(name);
  const Json patch = Json::diff(left, right);
  if (patch.empty()) {
    found.difference = difference_in_what_is_kept(a, b);
  } else {
    const std::string path = patch[0].at("path");
    found.difference = against(path.substr(1), Json::json_pointer(path), left, right);
  }
  return found;
}

}  // namespace isoline::benchmarks
