// isoline export DIR... --format csv|runs|coco --out PATH: writes results in the formats of other
// programs, by clients/python/export_results.py from the records.
#include <fmt/format.h>

#include <filesystem>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/output.h"
#include "core/text.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct ExportArguments {
  std::vector<std::string> folders;
  std::string format = "csv", out;
};

void declare(VerbArguments& verb, ExportArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--format", given.format,
            "csv: one row per stored point; runs: CSV of one row per run; coco: data folders for "
            "its post-processing")
      .one_of({"csv", "runs", "coco"})
      .shown();
  verb.text("--out", given.out, "Output: a file, or a new folder for several").required();
}

int run(const ExportArguments& given, Session& session) {
  const reports::Study study = study_of_report(given.folders, session);
  say_left_out(study.unreadable);
  const fs::path out = given.out;
  const bool is_file = given.format != "coco";
  std::error_code unknown;
  require(
      is_file || !is_there(out) || (fs::is_directory(out, unknown) && names_in(out).empty()),
      [&] { return fmt::format("{} exists already: name a new folder with --out", given.out); });
  if (!is_file) make_output_folder(out);
  const HiddenFolder folder;
  const fs::path runs = folder.path() / "runs.json", text = folder.path() / "text";
  write_text(runs, reports::json_of_runs(compare_optimizers(study)));
  std::vector<std::string> arguments = given.folders;
  arguments.insert(arguments.end(), {"--runs", runs.string(), "--format", given.format, "--out",
                                     is_file ? text.string() : out.string()});
  if (const int code = run_script("export_results.py", arguments); code != kGood) return code;
  if (is_file) {
    const std::string rows = read_text(text);
    write_output(out, rows, rows.substr(0, rows.find('\n')));
  }
  say(stdout, fmt::format("{}: {} as {}\n", given.out, reports::counted(study.runs.size(), "run"),
                          given.format));
  return kGood;
}

}  // namespace

void register_export(VerbRegistry& registry) {
  registry.add(verb_of<ExportArguments>(
      {.name = "export",
       .help_position = 120,
       .summary = "Write curves as CSV or as COCO data",
       .examples =
           R"(  isoline export results/quick --out curves.csv
  isoline export results/quick --format coco --out exdata)",
       .notes =
           "Reading the numbers back gives the same bits. Non-finite values are written as inf, "
           "-inf and nan. Needs pandas (Debian: python3-pandas)."},
      declare, run));
}

}  // namespace isoline::benchmarks
