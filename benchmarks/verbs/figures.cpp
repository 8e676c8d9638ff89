// isoline figures DIR... --format svg,pdf,pgf,csv: writes each plot of a report as files for
// papers, by clients/python/draw_figures.py from the JSON of the report.
#include <fmt/format.h>

#include <filesystem>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/output.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct FiguresArguments {
  std::vector<std::string> folders, formats = {"svg"};
  std::vector<std::string> methods;
  std::string out, only;
  double width = 3.2, tau = 1e-6;
  bool is_list = false, is_beside = false;
};

void declare(VerbArguments& verb, FiguresArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.texts("--format", given.formats, "Formats, between commas (default: svg)")
      .between_commas()
      .one_of({"svg", "pdf", "pgf", "csv"});
  verb.text("--only", given.only, "Write the figures whose names contain this text");
  verb.texts(
          "--methods", given.methods,
          "Draw these methods, by name, between commas (default: those that the page shows first)")
      .between_commas();
  constexpr double kLeast = 1, kMost = 20;
  verb.real("--width", given.width, between(kLeast, kMost), "Width in inches").shown();
  verb.real("--tau", given.tau, between(1e-10, 1),
            "Tolerance of the figures, as --tolerance of report")
      .shown("1e-6");
  verb.text("--out", given.out, "Output folder (default: figures/ in the first DIR)");
  verb.flag("--beside", given.is_beside, "Also write beside.FORMAT, all in one figure");
  verb.flag("--list", given.is_list, "List the names and titles, and write nothing");
}

int run(const FiguresArguments& given, Session& session) {
  const reports::Study study = study_of_report(given.folders, session);
  say_left_out(study.unreadable);
  const HiddenFolder folder;
  const fs::path report = folder.path() / "report.json";
  write_text(report,
             reports::json_report(document_of_report(
                 study, session, reports::yardstick_at(reports::Measure::work, given.tau))));
  const fs::path out =
      given.out.empty() ? given.folders.front() / fs::path("figures") : fs::path(given.out);
  if (!given.is_list) make_output_folder(out);
  std::vector<std::string> arguments = {report.string(),
                                        "--out",
                                        out.string(),
                                        "--format",
                                        reports::joined(given.formats, ","),
                                        "--width",
                                        fmt::format("{}", given.width)};
  for (const std::string& records : given.folders)
    arguments.insert(arguments.end(), {"--records", records});
  if (given.is_beside) arguments.emplace_back("--beside");
  if (!given.only.empty()) arguments.insert(arguments.end(), {"--only", given.only});
  if (!given.methods.empty())
    arguments.insert(arguments.end(), {"--methods", reports::joined(given.methods, ",")});
  if (given.is_list) arguments.emplace_back("--list");
  return run_script("draw_figures.py", arguments);
}

}  // namespace

void register_figures(VerbRegistry& registry) {
  registry.add(verb_of<FiguresArguments>(
      {.name = "figures",
       .help_position = 35,
       .summary = "Write the plots of a report as SVG, PDF, PGF and CSV",
       .examples = "  isoline figures results/quick --list\n"
                   "  isoline figures results/quick --only curves-heat --format pgf,csv",
       .notes = "A figure is as wide as the column of a paper; its letters have 7 points and more. "
                "SVG, PDF and PGF draw the lines that the page shows first, CSV has all lines. "
                "Figures are drawn by matplotlib (Debian: python3-matplotlib). PGF is for \\input "
                "and needs LaTeX (Debian: texlive-latex-base, texlive-pictures)."},
      declare, run));
}

}  // namespace isoline::benchmarks
