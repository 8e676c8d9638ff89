// What a report reads: the plan, the records and the sheets of one or several result folders.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/records/audited.h"
#include "core/records/plan.h"
#include "core/records/record.h"
#include "core/records/sheet.h"
#include "core/threads.h"
#include "reports/read/tuned_rates.h"

namespace isoline::reports {

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

}  // namespace isoline::reports
