// isoline export DIR... --format csv|coco --out PATH: results in the forms of others.
#include <fmt/format.h>

#include <filesystem>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "core/errors.h"
#include "core/files.h"
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
            "csv: one row per stored point; coco: data folders for its post-processing")
      .one_of({"csv", "coco"})
      .shown();
  verb.text("--out", given.out, "Output: a file; for coco, a new folder").required();
}

void write_file(const fs::path& out, const std::string& text) {
  if (out.has_parent_path()) fs::create_directories(out.parent_path());
  write_text(out, text);
}

void write_folder(const fs::path& out, const reports::CocoExport& coco) {
  std::error_code unknown;
  require(!is_there(out) || (fs::is_directory(out, unknown) && names_in(out).empty()),
          [&] { return fmt::format("{} exists already: export into a new folder", out.string()); });
  for (const auto& [name, text] : coco.files) write_file(out / name, text);
  for (const std::string& sentence : coco.left_out)
    say(stderr, fmt::format("left out: {}\n", sentence));
}

int run(const ExportArguments& given, Session&) {
  const reports::Study study =
      reports::read_study(given.folders, progress_on_terminal("reading records"));
  require(!study.runs.empty(), [&] {
    return fmt::format("no records in {}: `isoline run --out FOLDER` writes them",
                       reports::joined(given.folders));
  });
  const reports::Comparison comparison = compare_optimizers(study);
  if (given.format == "coco")
    write_folder(given.out, reports::coco_export(comparison));
  else
    write_file(given.out, reports::curves_csv(comparison));
  say(stdout, fmt::format("{}: {} as {}\n", given.out, reports::counted(study.runs.size(), "run"),
                          given.format));
  return kGood;
}

}  // namespace

void register_export(VerbRegistry& registry) {
  registry.add(verb_of(
      {.name = "export",
       .help_position = 120,
       .summary = "Write curves as CSV or as COCO data",
       .examples =
           "  isoline export results/quick --out curves.csv             one row per stored point\n"
           "  isoline export results/quick --format coco --out exdata   for COCO's "
           "post-processing",
       .notes = "Numbers survive the round trip exactly, including inf, -inf and nan."},
      declare, run));
}

}  // namespace isoline::benchmarks
