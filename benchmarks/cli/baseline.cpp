// isoline baseline RESULTS: what later results are compared with, as one small file.
#include "reports/gate/baseline.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"

namespace isoline::benchmarks {

using reports::baseline_json;
using reports::read_study;
using reports::Study;
namespace {

struct BaselineArguments {
  std::vector<std::string> folders;
  std::string out;
};

void keep_baseline(const BaselineArguments& given) {
  const Study study = read_study({given.folders.begin(), given.folders.end()});
  require(!study.runs.empty(), "there are no records to remember");
  const std::string text = baseline_json(study);
  if (given.out.empty()) {
    fmt::print("{}", text);
    return;
  }
  const std::filesystem::path folder = std::filesystem::path(given.out).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  write_text(given.out, text);
  fmt::print("{}: {} cells\n", given.out, study.runs.size());
}

}  // namespace

void add_baseline(CLI::App& app, Session&) {
  const auto given = std::make_shared<BaselineArguments>();
  CLI::App* verb = app.add_subcommand(
      "baseline", "Keep what later results are compared with, as one small file");
  verb->add_option("RESULTS", given->folders, "Result folders of `isoline run`")->required();
  verb->add_option("--out", given->out, "The file (default: standard output)");
  verb->footer(
      "A line a cell: status, digest of the trace, final figures, work to 1e-1, 1e-3 and 1e-6.\n"
      "Made by the portable preset it means the same on every x86-64-v3 machine:\n"
      "  ISOLINE_PRESET=portable isoline run quick --out results/quick\n"
      "  ISOLINE_PRESET=portable isoline baseline results/quick --out baseline.json\n"
      "  isoline compare baseline.json results/quick");
  verb->callback([given] { keep_baseline(*given); });
}

}  // namespace isoline::benchmarks
