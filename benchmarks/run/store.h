// A result folder: the planned cells, the finished ones, the running ones, and one complete file
// per record.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/records/record.h"
#include "core/records/request.h"
#include "core/records/sheet.h"

namespace isoline::benchmarks {

class Store {
 public:
  explicit Store(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }

  // Adds the cells to the stored plan; those of earlier runs stay planned. A damaged plan is set
  // aside.
  void plan(const std::string& suite, const std::vector<PlannedCell>& cells);

  // The record of this request by this build, unless it is missing, damaged or interrupted. A
  // damaged one is moved away, by `find_in` it is left.
  std::optional<Record> find(const Request& request);
  static std::optional<Record> find_in(const std::filesystem::path& folder, const Request& request);

  // The file name of this build's record of the request, and whether anything has this name.
  static std::string name_of(const Request& request);
  bool has(const Request& request) const;

  // Creates the folder and its subfolders if they are missing; UsageError if that fails.
  void make_folders() const;
  // Moves a file that is not what it should be into `damaged/`, where nothing is ever overwritten,
  // with a remark that names it and the reason.
  void set_aside(const std::filesystem::path& path, const std::string& reason);

  // Messages for the user, one sentence each.
  void remark(std::string sentence) { remarks_.push_back(std::move(sentence)); }
  const std::vector<std::string>& remarks() const { return remarks_; }

  // Keeps the record for flush(), which writes all that wait, each whole; times of an earlier
  // record of the same cell and build join its own.
  void keep(Record record, const std::optional<Record>& earlier);
  void flush();
  void write(Record record, const std::optional<Record>& earlier);  // both
  void remove(const Request& request) const;                        // its record
  void write(const Sheet& sheet);

  // Where a run of this request by this build is kept while it goes.
  std::filesystem::path checkpoint_path(const Request& request) const;
  void remove_checkpoint(const Request& request) const;
  void look_for_states();  // once before many cells, which then need not look for theirs
  bool has_states() const { return !states_.empty(); }
  // States of runs of this build that differ from the request in their budget of iterations and
  // work alone: what their files' names begin with; the file of one that needs this budget; and the
  // latest one within the budget of the request, or nothing.
  std::filesystem::path end_stem(const Request& request) const;
  static std::filesystem::path end_path(const std::filesystem::path& stem, const Budget& needed);
  std::filesystem::path end_within_budget(const Request& request) const;

 private:
  // Creates the folders again if they are removed during the run.
  void try_to_write(const std::function<void()>& write);
  // Moves a folder or a pipe away from where a file is to stand. False if nothing stood there.
  bool clear_way(const std::filesystem::path& path);

  std::filesystem::path folder_;
  std::vector<std::string> remarks_;
  std::vector<std::pair<std::filesystem::path, std::string>> waiting_;  // texts for flush()
  std::set<std::filesystem::path> obsolete_;  // fields that earlier runs have kept: it removes them
  std::set<std::string> states_;              // names of files, as look_for_states() found them
};

// The record of a request in a folder, of any build.
class RecordsOfAnyBuild {
 public:
  explicit RecordsOfAnyBuild(const std::filesystem::path& folder);  // which need not be there

  bool has(const Request& request) const { return paths_.contains(request.cell); }
  // The newest one: none that failed or that a clock or a kill ended.
  std::optional<Record> find(const Request& request) const;

 private:
  std::map<std::string, std::vector<std::filesystem::path>> paths_;  // by cell
};

// Locks on one file of the folder, one byte per cell. The system releases them when their process
// ends, in whatever way; its children do not share them. On a file system without locks some work
// is done twice, and nothing is lost. One object per folder and process: closing the file drops
// all.
class Holds {
 public:
  explicit Holds(const std::filesystem::path& folder);
  ~Holds();
  Holds(const Holds&) = delete;
  Holds& operator=(const Holds&) = delete;

  bool take(const std::string& cell);  // false while another process has it
  void release(const std::string& cell);

 private:
  int descriptor_;
};

// How many cells of a result folder runs in other processes hold at the moment, according to the
// file system; 0 if the folder has none.
std::size_t held_cells(const std::filesystem::path& folder);

// Whether two runs of one cell by one build gave the same, bit for bit, timings aside.
bool same_result(const Record& a, const Record& b);

struct Comparison {
  std::string difference;       // the first, "loss at iteration 17: 0.25 against 0.26"; empty: none
  std::int64_t iterations = 0;  // up to here
  bool is_up_to_there = false;  // a clock or a kill ended one of them: only so far
};

// The curve first, by iteration, then all else that the request and not the build decides.
Comparison compare_results(const Record& a, const Record& b);

}  // namespace isoline::benchmarks
