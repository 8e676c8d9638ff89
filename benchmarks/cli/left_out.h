// Files that the readers of result folders passed over.
#pragma once

#include <string>
#include <vector>

#include "core/results/study.h"

namespace isoline::benchmarks {

// Counts and names it on standard error; returns how many files.
std::size_t say_left_out(const std::vector<results::Unreadable>& unreadable);

// The records of result folders; says what it left out.
results::Study study_of(const std::vector<std::string>& folders);

}  // namespace isoline::benchmarks
