// Reads a result folder as subjects of a comparison, record by record: a hundred thousand of them
// take a tenth of the memory of their curves.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/threads.h"
#include "reports/compare/subject.h"

namespace isoline::reports {

struct FolderSubjects {
  std::vector<Subject> subjects;  // by problem, optimizer, seed
  BestKnown best;                 // of the folder's own runs
  std::size_t unreadable = 0, superseded = 0;
};

// `reference` sets f_L where a problem declares none; else the folder's own runs do. A missing
// folder is a UsageError.
FolderSubjects read_subjects(const std::string& folder, const std::optional<BestKnown>& reference,
                             const Listener& listener = {});

}  // namespace isoline::reports
