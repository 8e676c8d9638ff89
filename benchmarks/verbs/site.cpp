// isoline site DIR... --out FOLDER: writes a static site of several results.
#include <fmt/format.h>

#include <deque>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/claim_cells.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/output.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

const std::map<std::string, std::string_view>& builtin_docs();

namespace {

namespace fs = std::filesystem;

struct SiteArguments {
  std::vector<std::string> folders;
  std::string out = "site";
};

void declare(VerbArguments& verb, SiteArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--out", given.out, "Output folder").shown();
}

// Markdown with tables, as HTML by cmark-gfm.
std::map<std::string, std::string> docs_html() {
  const HiddenFolder folder;
  const fs::path from = folder.path() / "page.md", to = folder.path() / "page.html";
  std::map<std::string, std::string> pages;
  for (const auto& [name, text] : builtin_docs()) {
    write_text(from, text);
    run_program({"cmark-gfm", "--extension", "table", from.string()}, "cmark-gfm", to);
    pages[name] = read_text(to);
  }
  return pages;
}

// The runs that claims of papers need, of all results.
std::vector<Record> claimed_runs(const std::deque<reports::Study>& studies,
                                 const std::vector<Claim>& claims) {
  std::set<std::string> claimed;
  for (const Request& request : cells_of(claims, true)) claimed.insert(request.cell);
  std::vector<Record> runs;
  for (const reports::Study& study : studies)
    for (const Record& run : study.runs)
      if (claimed.erase(run.cell) > 0) runs.push_back(run);
  return runs;
}

// The report with its figures as files.
int write_results(const reports::SiteResults& results, const fs::path& out) {
  const fs::path report = out / "reports" / reports::file_name_of(results.name);
  reports::write_report(*results.document, report);
  make_output_folder(report / "figures");
  return run_script("draw_figures.py",
                    {(report / "report.json").string(), "--out", (report / "figures").string(),
                     "--format", "svg,csv", "--quiet"});
}

int run(const SiteArguments& given, Session& session) {
  const fs::path out = given.out;
  make_output_folder(out);
  std::deque<reports::Study> studies;
  std::deque<reports::Document> documents;
  const std::vector<Claim>& claims = session.claims();
  reports::Site site{.docs = docs_html()};
  std::set<std::string> names;
  for (const std::string& folder : given.folders) {
    const std::string name = fs::weakly_canonical(folder).filename().string();
    require(names.insert(reports::file_name_of(name)).second, [&] {
      return fmt::format("two result folders have the name {}; a site needs different ones", name);
    });
    studies.push_back(study_of_report({folder}, session));
    say_left_out(studies.back().unreadable);
    documents.push_back(document_of_report(studies.back(), session));
    site.results.push_back({name, &documents.back(), reports::drawings_of(documents.back())});
  }
  site.claims = reports::judge(json_of(claims), claimed_runs(studies, claims),
                               published_records(session.catalog()));
  site.items = reports::items_section(parse_json(std::string(embedded_papers()), "papers"));
  for (const reports::SiteResults& results : site.results)
    if (const int code = write_results(results, out); code != kGood) return code;
  std::size_t bytes = 0;
  const std::map<std::string, std::string> pages = reports::site_pages(site);
  for (const auto& [path, text] : pages) {
    make_output_folder((out / path).parent_path());
    write_text(out / path, text);
    bytes += text.size();
  }
  say(stdout, fmt::format("{}: {} with {:.1f} MB, and {}\n", (out / "index.html").string(),
                          reports::counted(pages.size(), "file"), double(bytes) / 1e6,
                          reports::counted(site.results.size(), "report")));
  return kGood;
}

}  // namespace

void register_site(VerbRegistry& registry) {
  registry.add(verb_of<SiteArguments>(
      {.name = "site",
       .help_position = 37,
       .summary = "Write a static site of several results",
       .examples = "  isoline site results/quick results/nist --out site",
       .notes =
           "The site has a page per suite, problem, method, paper and page of the "
           "documentation, and the full report of each result folder. It needs no server and "
           "no scripts. The documentation is converted by cmark-gfm (Debian: cmark-gfm), and figures "
           "are drawn by matplotlib (Debian: python3-matplotlib)."},
      declare, run));
}

}  // namespace isoline::benchmarks
