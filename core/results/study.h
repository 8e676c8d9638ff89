// The input of a report: the plan, the records and the component metadata of result folders.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "core/real.h"
#include "core/records/audited.h"
#include "core/records/plan.h"
#include "core/records/record.h"
#include "core/records/sheet.h"
#include "core/threads.h"

namespace isoline::results {

// A row of a table of rates.
struct TunedRate {
  std::string problem, optimizer;  // the problem's spec, the optimizer's name
  std::string file;                // the table of rates that it stands in
  std::string paper;               // that published it; empty where a grid was tried
  std::string option;              // that was chosen: "rate"
  // For a grid: its values, and the work of each to its tolerance, the median over the tuning
  // seeds; infinite if it was not reached.
  std::vector<Real> values, work;
  bool is_at_edge = false;  // the best value is the first or the last

  bool is_tuned() const { return !values.empty(); }
  bool is_ever_solved() const;
};

// None where the folder has no such file.
std::vector<TunedRate> read_rates(const std::string& folder);
std::vector<TunedRate> rates_from_text(const std::string& text, const std::string& origin);

// The input of a report: the plan, the records and the component metadata of result folders.

// A file that is no record, sheet or plan. It is listed, so that nothing vanishes in silence.
struct Unreadable {
  std::string file;
  std::string reason;
};

struct Study {
  Plan plan;                 // the union of the folders' plans
  std::vector<Record> runs;  // one a cell, by its newest build; by problem, optimizer, seed
  std::vector<Sheet> sheets;
  std::vector<AuditedOptimizer> audits;  // by name; of several folders the first that has it
  std::vector<TunedRate> rates;          // rows of tables of rates that runs used
  std::vector<Unreadable> unreadable;
  std::size_t superseded = 0;      // readable records left aside for a newer one of the same cell
  std::set<std::string> disputed;  // cells of which two records of one build hold other results
  std::vector<std::string> folders;

  // The fields beside a record with their numbers; nothing where it keeps none, or where they
  // cannot be read.
  std::optional<FieldFrames> fields_of(const Record& record) const;
};

// Folders are laid out as core/records/sheet.h says; a missing one is a UsageError. The listener is
// told of the records.
Study read_study(const std::vector<std::string>& folders, const Listener& listener = {});

// Among all records of a cell the newest counts, independent of its build.

// The criterion between records of a cell, and the order of several.
struct RunMark {
  std::string cell, build, started, problem, optimizer;  // its digests; when; its specs
  std::uint64_t seed = 0;
  bool is_nondeterministic = false;
};
RunMark mark_of(const Record& record);

struct Newest {
  std::vector<std::size_t> kept;   // one a cell, by problem, optimizer and seed
  std::size_t superseded = 0;      // left aside for a newer one
  std::set<std::string> disputed;  // cells of which two records of one build hold other results
};

// A mark without a cell stands for no record. Whether two of one build hold other results is asked
// only where both should hold the same.
Newest newest_of(const std::vector<RunMark>& marks,
                 const std::function<bool(std::size_t, std::size_t)>& are_at_odds);

// Whether they hold other results, times aside.
bool are_at_odds(const Record& a, const Record& b);

// The files of result folders, by name: as text, for each path that knows its parts is a kilobyte.

// The JSON files of a folder, of any kind; if the folder cannot be listed, the reason.
std::vector<std::string> json_files(const std::filesystem::path& folder,
                                    std::vector<Unreadable>& unreadable);

// Those of the records of all folders.
std::vector<std::string> record_files(const std::vector<std::string>& folders,
                                      std::vector<Unreadable>& unreadable);

}  // namespace isoline::results
