// isoline export DIR... --format csv|coco|bencher --out PATH: results in the forms of others.
#include <fmt/format.h>

#include <filesystem>

#include "benchmarks/cli/on_terminal.h"
#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"
#include "reports/exports/exports.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::bencher_json;
using reports::coco_export;
using reports::CocoExport;
using reports::Comparison;
using reports::counted;
using reports::curves_csv;
using reports::ExportedFile;
using reports::joined;
using reports::read_study;
using reports::Study;

namespace {

namespace fs = std::filesystem;

void write_file(const fs::path& out, const std::string& text) {
  if (out.has_parent_path()) fs::create_directories(out.parent_path());
  write_text(out, text);
}

void write_folder(const fs::path& out, const CocoExport& coco) {
  std::error_code unknown;
  require(!is_there(out) || (fs::is_directory(out, unknown) && names_in(out).empty()),
          [&] { return fmt::format("{} exists already: export into a new folder", out.string()); });
  for (const ExportedFile& file : coco.files) write_file(out / file.name, file.text);
  for (const std::string& sentence : coco.left_out)
    say(stderr, fmt::format("left out: {}\n", sentence));
}

}  // namespace

int export_verb(const ExportArguments& given, Session&) {
  const Study study = read_study(given.folders, on_terminal("reading records"));
  require(!study.runs.empty(), [&] {
    return fmt::format("no records in {}: `isoline run --out FOLDER` writes them",
                       joined(given.folders));
  });
  const Comparison comparison = compare_optimizers(study);
  if (given.format == "coco")
    write_folder(given.out, coco_export(comparison));
  else
    write_file(given.out,
               given.format == "csv" ? curves_csv(comparison) : bencher_json(comparison));
  say(stdout,
      fmt::format("{}: {} as {}\n", given.out, counted(study.runs.size(), "run"), given.format));
  return kGood;
}

}  // namespace isoline::benchmarks
