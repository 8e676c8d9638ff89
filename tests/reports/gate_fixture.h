// Two result folders, one of them edited, for tests of the gate.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "reports/compare/gate.h"
#include "tests/reports/fixture.h"
#include "tests/reports/true_record.h"

namespace isoline::reports {

inline constexpr Real kTolerance = 1e-6;  // of the gate of this repository

using Edit = std::function<void(Record&)>;
using Edits = std::map<std::uint64_t, Edit>;  // by seed

inline void as_it_was(Record&) {}

inline Edit loss_times(Real factor) {
  return [factor](Record& record) { end_at(record, record.summary.loss * factor); };
}
inline void take_five_percent_more_work(Record& record) {
  for (std::vector<std::int64_t>* works :
       {&record.hits->work, &record.hits->forwards, &record.curve.work})
    for (std::int64_t& work : *works) work += work / 20;
  record.summary.work += record.summary.work / 20;
}
inline Edit ends_as(Status status) {
  return [status](Record& record) { record.status = status; };
}

// So many cells of square × gd, of which those named are edited.
inline void fill(const ResultFolder& folder, const Edits& edits = {}, std::uint64_t seeds = 12) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    Record record = record_of({.seed = seed, .hits = 20 + seed, .status = Status::budget});
    record.repeat_wall_seconds = {0.1, 0.2};
    if (const auto edit = edits.find(seed); edit != edits.end()) edit->second(record);
    folder.add(record);
  }
}

// Of two problems and some optimizers, all edited. The cells are digests of what is asked then.
inline void fill(const ResultFolder& folder, const std::vector<std::string>& optimizers,
                 const Edit& edit, std::uint64_t seeds = 2) {
  for (const char* problem : {"sine", "square"})
    for (const std::string& optimizer : optimizers)
      for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        Record record = record_of({.problem = problem,
                                   .optimizer = optimizer,
                                   .seed = seed,
                                   .hits = 20,
                                   .status = Status::budget});
        edit(record);
        record.cell = cell_digest(record.request);
        folder.add(record);
      }
}

struct TwoFolders {
  ResultFolder before, after;
  GateResult compared(const GateOptions& options = {}) const {
    return compare_results(before.path(), after.path(), options);
  }
};

// Cell 5 of twelve is edited.
inline GateResult compared(const Edit& edit, const GateOptions& options = {}) {
  const TwoFolders two;
  fill(two.before);
  fill(two.after, {{5, edit}});
  return two.compared(options);
}

}  // namespace isoline::reports
