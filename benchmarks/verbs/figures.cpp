// isoline figures DIR... --format svg,pdf,pgf,csv: writes each plot of a report as files for
// papers.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/output.h"
#include "core/text.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct FiguresArguments {
  std::vector<std::string> folders, formats = {"svg"};
  std::string out, only;
  bool is_list = false;
};

void declare(VerbArguments& verb, FiguresArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.texts("--format", given.formats, "Formats, between commas (default: svg)")
      .between_commas()
      .one_of({"svg", "pdf", "pgf", "csv"});
  verb.text("--only", given.only, "Write the figures whose names contain this text");
  verb.text("--out", given.out, "Output folder (default: figures/ in the first DIR)");
  verb.flag("--list", given.is_list, "List the names and titles, and write nothing");
}

void write_figure(const reports::NamedDrawing& one, const std::string& format,
                  const fs::path& out) {
  const fs::path file = out / (one.name + "." + format);
  if (format == "csv") return write_text(file, reports::points_csv(one.drawing));
  if (format == "pgf") return write_text(file, reports::paper_pgf(one.drawing));
  const std::string svg = reports::paper_svg(one.drawing);
  if (format == "svg") return write_text(file, svg);
  const HiddenFolder folder;
  write_text(folder.path() / "figure.svg", svg);
  run_program({"rsvg-convert", "--format=pdf", "--output=" + file.string(),
               (folder.path() / "figure.svg").string()},
              "librsvg2-bin");
}

int run(const FiguresArguments& given, Session& session) {
  const reports::Study study = study_of_report(given.folders, session);
  std::vector<reports::NamedDrawing> all = reports::drawings_of(document_of_report(study, session));
  const std::size_t count = all.size();
  std::erase_if(all, [&](const reports::NamedDrawing& one) {
    return one.name.find(given.only) == std::string::npos;
  });
  require(!all.empty(), [&] {
    return count == 0 ? "these results have no figures"
                      : fmt::format(
                            "--only {}: none of the {} contains this text; --list prints "
                            "their names",
                            given.only, reports::counted(count, "figure name"));
  });
  if (given.is_list) {
    for (const reports::NamedDrawing& one : all)
      say(stdout, fmt::format("{:40} {}\n", one.name, one.drawing.plot.title));
    return kGood;
  }
  const fs::path out =
      given.out.empty() ? given.folders.front() / fs::path("figures") : fs::path(given.out);
  make_output_folder(out);
  for (const std::string& format : given.formats)
    for (const reports::NamedDrawing& one : all) write_figure(one, format, out);
  say(stdout, fmt::format("{}: {} as {}\n", out.string(), reports::counted(all.size(), "figure"),
                          reports::joined(given.formats)));
  return kGood;
}

}  // namespace

void register_figures(VerbRegistry& registry) {
  registry.add(verb_of<FiguresArguments>(
      {.name = "figures",
       .help_position = 35,
       .summary = "Write the plots of a report as SVG, PDF, PGF and CSV",
       .examples = "  isoline figures results/quick --list\n"
                   "  isoline figures results/quick --only curves-heat --format pgf,csv",
       .notes = "A figure is 3.2 inches wide, the column of a paper; its letters have 7 points and "
                "more. SVG, PDF and PGF draw the lines that the page shows first, CSV has all "
                "lines. PGF is for \\input and needs the package pgf; PDF needs rsvg-convert "
                "(Debian: librsvg2-bin)."},
      declare, run));
}

}  // namespace isoline::benchmarks
