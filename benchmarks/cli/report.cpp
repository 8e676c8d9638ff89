// isoline report DIR...: tables, plots and statistics from records.
#include "reports/report.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "benchmarks/cli/verbs.h"

namespace isoline::benchmarks {

using reports::compare_optimizers;
using reports::Document;
using reports::document_of;
using reports::read_study;
using reports::Study;
using reports::terminal_table;
using reports::write_report;

void add_report(CLI::App& app, Session& session) {
  struct Options {
    std::vector<std::string> folders;
    std::string out;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "report",
      "Write index.html, report.md, report.tex, report.csv, statistics.csv and report.json");
  verb->add_option("DIR", options->folders, "Result folders of `isoline run`")->required();
  verb->add_option("--out", options->out, "Where to write (default: report/ in the first DIR)");
  verb->callback([options, &session] {
    namespace fs = std::filesystem;
    const std::vector<fs::path> folders(options->folders.begin(), options->folders.end());
    const fs::path out = options->out.empty() ? folders.front() / "report" : fs::path(options->out);
    const Study study = read_study(folders, on_terminal("reading records"));
    const Document document =
        document_of(compare_optimizers(study), covered_claims(session, study));
    write_report(document, out);
    fmt::print("{}\nreport: {}\n", terminal_table(document), (out / "index.html").string());
  });
}

}  // namespace isoline::benchmarks
