// A study reported as `run` and `report` do it: every format in a folder, the main table on the
// terminal.
#pragma once

#include <filesystem>

#include "reports/study.h"

namespace isoline::benchmarks {

class Session;

void write_and_print(const reports::Study& study, const std::filesystem::path& out,
                     Session& session, bool quiet = false);

}  // namespace isoline::benchmarks
