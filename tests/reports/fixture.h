// Synthetic result folders: what the tests of reports read, and pages to look at.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/records/record.h"
#include "core/records/sheet.h"
#include "core/results/study.h"

namespace isoline::reports {

using namespace results;

// A folder of its own, removed at the end.
class ResultFolder {
 public:
  ResultFolder();
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void add(const Record& record) const;
  void add(const Sheet& sheet) const;
  void add(const Plan& plan) const;
  void add_file(const std::string& name, const std::string& text) const;  // name within the folder

 private:
  std::filesystem::path path_;
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

// A study with something of everything: landscapes and paths on `square` and `sine`, learning
// problems without a declared minimum, privileges, failures, inapplicable and missing cells.
struct Size {
  std::size_t problems = 16, optimizers = 33, seeds = 5, points = 64;
};
void write_sample_study(const std::filesystem::path& folder, const Size& size);

}  // namespace isoline::reports
