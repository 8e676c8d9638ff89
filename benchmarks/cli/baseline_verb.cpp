// isoline baseline RESULTS: what later results are compared with, as one small file.
#include <fmt/format.h>

#include <filesystem>

#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/files.h"
#include "reports/gate/baseline.h"
#include "reports/read/study.h"

namespace isoline::benchmarks {

using reports::baseline_json;
using reports::read_study;
using reports::Study;

int baseline_verb(const BaselineArguments& given, Session&) {
  const Study study = read_study({given.folders.begin(), given.folders.end()});
  require(!study.runs.empty(), "there are no records to remember");
  const std::string text = baseline_json(study);
  if (given.out.empty()) {
    fmt::print("{}", text);
    return kGood;
  }
  const std::filesystem::path folder = std::filesystem::path(given.out).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  write_text(given.out, text);
  fmt::print("{}: {} cells\n", given.out, study.runs.size());
  return kGood;
}

}  // namespace isoline::benchmarks
