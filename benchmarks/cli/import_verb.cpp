// isoline import CURVE.csv --out DIR: a curve that others computed, as a record of a result folder.
#include <fmt/format.h>

#include <filesystem>

#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/import/imported_record.h"
#include "benchmarks/run/sheets.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/plan.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostCurveBytes = std::size_t{1} << 30;
constexpr std::size_t kMostDescriptionBytes = std::size_t{1} << 20;

Sheet optimizer_sheet_of(const Record& record) {
  return {.kind = "optimizer",
          .name = record.request.optimizer.name,
          .spec = record.request.optimizer.spec,
          .title = "imported: a method of others, by its own figures",
          .source = record.imported->source,
          .note = "Imported from " + record.imported->curve +
                  ": nothing of it was run or verified here.",
          .options_text = "[]",
          .family = "imported"};
}

// What the registry knows of the problem, or the description tells.
Sheet problem_sheet_of(const Catalog& catalog, const Record& record, const CurveDescription& told) {
  const Component& problem = record.request.problem;
  if (catalog.problems.contains(problem.name)) return problem_sheet(catalog, problem);
  return {.kind = "problem",
          .name = problem.name,
          .spec = problem.spec,
          .title = "a problem of others",
          .source = told.source,
          .options_text = "[]",
          .inverse = "none",
          .unknowns = told.unknowns,
          .residuals = told.residuals};
}

// A sheet that a run has left there knows more.
void write_if_absent(const fs::path& folder, const Sheet& sheet) {
  const fs::path file = folder / sheet.file_name();
  if (!is_there(file)) write_text(file, file_text(sheet));
}

}  // namespace

int import_verb(const ImportArguments& given, Session& session) {
  const fs::path curve = given.curve;
  const fs::path description = given.description.empty()
                                   ? fs::path(curve).replace_extension(".json")
                                   : fs::path(given.description);
  const ForeignFiles files{.curve = read_text(curve, kMostCurveBytes),
                           .description = read_text(description, kMostDescriptionBytes),
                           .curve_name = valid_utf8(curve.filename().string())};
  const CurveDescription told = description_from_text(files.description, description.string());
  const ForeignCurve points = curve_from_text(files.curve, curve.string(), told);
  const Record record = imported_record(session.catalog(), told, points, files);
  const fs::path out = given.out;
  fs::create_directories(out / "runs");
  fs::create_directories(out / "components");
  write_text(out / "runs" / record.file_name(), file_text(record));
  write_if_absent(out / "components", problem_sheet_of(session.catalog(), record, told));
  write_if_absent(out / "components", optimizer_sheet_of(record));
  if (!session.catalog().problems.contains(record.request.problem.name))
    say(stdout, fmt::format("{} is no problem of ours: it stands in a table of its own\n",
                            record.request.problem.name));
  say(stdout, fmt::format("{}: {} × {}, seed {}, {}, {} kept: imported, never verified\n",
                          (out / "runs" / record.file_name()).string(), record.request.problem.spec,
                          record.request.optimizer.spec, record.request.seed,
                          counted(points.points(), "point"), record.curve.loss.size()));
  return kGood;
}

}  // namespace isoline::benchmarks
