// isoline export DIR... --format csv|coco --out PATH: writes results in the formats of other
// programs.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

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
  std::vector<std::string> names;
  std::string help;
  for (const reports::ExportFormat& format : reports::kExportFormats) {
    help += fmt::format("{}{}: {}", help.empty() ? "" : "; ", format.name, format.help);
    names.emplace_back(format.name);
  }
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--format", given.format, help.c_str()).one_of(names).shown();
  verb.text("--out", given.out, "Output: a file, or a new folder for several").required();
}

void write_file(const fs::path& out, const std::string& text) {
  write_output(out, text, text.substr(0, text.find('\n')));
}

int run(const ExportArguments& given, Session&) {
  const reports::Study study =
      reports::read_study(given.folders, progress_on_terminal("reading records"));
  require(!study.runs.empty(), [&] {
    return fmt::format("no records in {}; `isoline run --out FOLDER` creates some",
                       reports::joined(given.folders));
  });
  const fs::path out = given.out;
  const auto* format =
      std::ranges::find(reports::kExportFormats, given.format, &reports::ExportFormat::name);
  const reports::Export made = format->write(compare_optimizers(study));
  std::error_code unknown;
  const bool is_file = made.files.contains("");
  require(
      is_file || !is_there(out) || (fs::is_directory(out, unknown) && names_in(out).empty()),
      [&] { return fmt::format("{} exists already: name a new folder with --out", given.out); });
  for (const auto& [name, text] : made.files) write_file(is_file ? out : out / name, text);
  for (const std::string& sentence : made.left_out)
    say(stderr, fmt::format("left out: {}\n", sentence));
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
           "-inf and nan."},
      declare, run));
}

}  // namespace isoline::benchmarks
