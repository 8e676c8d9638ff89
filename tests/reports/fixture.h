// Synthetic result folders: what the tests of reports read, and pages to look at.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/records/record.h"
#include "core/records/sheet.h"
#include "core/results/ranking.h"
#include "core/results/study.h"
#include "reports/sections/section.h"
#include "tests/temporary_folder.h"

namespace isoline::reports {

using namespace results;

// A folder of its own, removed at the end.
class ResultFolder {
 public:
  ResultFolder();
  const std::filesystem::path& path() const { return owned_.path(); }
  void add(const Record& record) const;
  void add(const Sheet& sheet) const;
  void add(const Plan& plan) const;
  void add_file(const std::string& name, const std::string& text) const;  // name within the folder

 private:
  TemporaryFolder owned_;
};

// A run that reaches τ = 10^(−j/5) after j · work_per_hit forwards, until `hits` are reached.
struct PlainRun {
  std::string problem = "square", optimizer = "gd";
  std::uint64_t seed = 0;
  std::size_t hits = 51;
  std::int64_t work_per_hit = 2;
  Status status = Status::target;
  std::string message, started = "2026-01-01T00:00:00Z", build = "b0";
};
Record record_of(const PlainRun& run);
Plan plan_of(const std::vector<Record>& records);

// A study of single runs. Work to 1e-6 is 30 times `per_hit`; 0 stands for a run that never gets
// there.
struct Result {
  const char* problem;
  const char* optimizer;
  int per_hit;
};
Study study_of(const std::vector<Result>& results);

// These records compared: a comparison that holds its study.
struct OwnedStudy {
  Study owned;
};
struct Compared : OwnedStudy, Comparison {
  explicit Compared(std::vector<Record> runs, const Yardstick& yardstick = {});
  explicit Compared(Study study, const Yardstick& yardstick = {});
  Compared(const Compared&) = delete;
};

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The text of the cell of a table, in the row that begins so, of this column.
std::string at(const Table& table, const std::string& row, const std::string& column);

}  // namespace isoline::reports
