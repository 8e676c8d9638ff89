// The verbs site and figures: pages without dead links, figures and a report that LaTeX compiles.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

class Site : public testing::Test {
 protected:
  void SetUp() override {
    shell.expect(
        "./isoline run --problem rosenbrock,beale,sine --optimizer gd,adam,newton,gauss-newton "
        "--seeds 3 --iterations 60 --out out --no-report --quiet");
  }
  bool has_program(const std::string& name) const {
    return shell("command -v " + name).exit_code == 0;
  }
  bool has_matplotlib() const {
    return shell("/usr/bin/python3 -c 'import matplotlib'").exit_code == 0;
  }

  Shell shell;
};

// What an attribute holds, over a whole page, quoted or not.
std::set<std::string> values_of(const std::string& page, const std::string& attribute) {
  const std::regex pattern("[ \n]" + attribute + "=(?:\"([^\"]*)\"|([^ >\n]+))");
  std::set<std::string> all;
  for (std::sregex_iterator at(page.begin(), page.end(), pattern), end; at != end; ++at)
    all.insert((*at)[1].matched ? (*at)[1].str() : (*at)[2].str());
  return all;
}

TEST_F(Site, HasNoDeadLinkAndEachPageIsValid) {
  if (!has_program("cmark-gfm")) GTEST_SKIP() << "cmark-gfm is not installed";
  if (!has_matplotlib()) GTEST_SKIP() << "matplotlib is not installed";
  std::string settings = "linear-chain[steps=24]";
  for (int steps = 25; steps <= 37; ++steps)
    settings += fmt::format(",linear-chain[steps={}]", steps);
  shell.expect("./isoline run --problem '" + settings +
               "' --optimizer gd,gauss-newton --iterations 20 --out many --no-report --quiet");
  shell.expect("./isoline site out many --out site", {.out = {"site/index.html", "2 reports"}});
  const fs::path site = shell.folder() / "site";
  std::map<fs::path, std::set<std::string>> anchors;
  const auto has_anchor = [&](const fs::path& file, const std::string& anchor) {
    if (!anchors.contains(file)) anchors[file] = values_of(read_text(file), "id");
    return anchors[file].contains(anchor);
  };
  std::size_t pages = 0, links = 0;
  for (const auto& entry : fs::recursive_directory_iterator(site)) {
    const std::string name = fs::relative(entry.path(), site).string();
    if (entry.path().extension() != ".html" || name.starts_with("reports/")) continue;
    ++pages;
    const std::string page = read_text(entry.path());
    EXPECT_FALSE(contains(page, "<script")) << name;
    for (const std::string& address : values_of(page, "href")) {
      if (address.starts_with("http") || address == "data:,") continue;
      ++links;
      const std::size_t hash = std::min(address.find('#'), address.size());
      const fs::path target =
          hash == 0 ? entry.path()
                    : (entry.path().parent_path() / address.substr(0, hash)).lexically_normal();
      ASSERT_TRUE(fs::exists(target)) << name << ": " << address;
      if (hash < address.size()) {
        EXPECT_TRUE(has_anchor(target, address.substr(hash + 1))) << name << ": " << address;
      }
    }
  }
  EXPECT_GT(pages, 25U);
  EXPECT_GT(links, 300U);
  for (const char* page : {"problems/rosenbrock.html", "methods/newton.html", "suites/out.html",
                           "docs/glossary.html", "reports/out/index.html"})
    EXPECT_TRUE(fs::exists(site / page)) << page;
  const std::string many = read_text(site / "problems/linear-chain.html");
  EXPECT_EQ(std::ranges::count_if(values_of(many, "href"),
                                  [](const std::string& address) {
                                    return contains(address, "/many/index.html#problem-");
                                  }),
            14)
      << "one row per setting";
  std::size_t curves = 0;
  for (std::size_t at = 0; (at = many.find("<figure", at)) != many.npos; ++at) ++curves;
  EXPECT_EQ(curves, 4U) << "the first settings in full";
  if (!has_program("tidy")) GTEST_SKIP() << "tidy is not installed";
  shell.expect(
      "for page in $(find site -name '*.html' -not -path '*/reports/*'); do "
      "tidy -quiet -errors --show-warnings no \"$page\"; [ $? -lt 2 ] || exit 1; done");
}

TEST_F(Site, FiguresHaveThePointsOfThePlots) {
  if (!has_matplotlib()) GTEST_SKIP() << "matplotlib is not installed";
  shell.expect("./isoline figures out --list", {.out = {"curves-rosenbrock"}});
  shell.expect(
      "./isoline figures out --beside --only curves-rosenbrock --format svg,pdf,csv --out drawn",
      {.out = {"1 figure as svg, pdf, csv"}});
  shell.expect("./isoline figures out --only nothing", {.exit_code = 1, .err = {"--list"}});
  const fs::path drawn = shell.folder() / "drawn";
  EXPECT_TRUE(contains(read_text(drawn / "beside.svg"), ">gauss-newton</text>"));
  const std::string csv = read_text(drawn / "curves-rosenbrock.csv");
  EXPECT_TRUE(csv.starts_with("line,x,y,low,high\r\n")) << csv;
  for (const char* method : {"gd", "adam", "newton", "gauss-newton"})
    EXPECT_TRUE(contains(csv, std::string("\n") + method)) << method;
  const std::string svg = read_text(drawn / "curves-rosenbrock.svg");
  EXPECT_TRUE(contains(svg, ">gauss-newton</text>")) << svg;
  const std::regex size("font: (\\d+)px");
  std::size_t texts = 0;
  for (std::sregex_iterator at(svg.begin(), svg.end(), size), end; at != end; ++at, ++texts)
    EXPECT_GE(std::stoi((*at)[1]), 7) << "points, in a column of 3.2 inches";
  EXPECT_GT(texts, 8U);
  EXPECT_TRUE(read_text(drawn / "curves-rosenbrock.pdf").starts_with("%PDF"));
  shell.expect("./isoline figures out --only curves-rosenbrock --methods adam,newton --out two");
  const std::string two = read_text(shell.folder() / "two" / "curves-rosenbrock.svg");
  EXPECT_TRUE(contains(two, ">adam") && !contains(two, ">gauss-newton")) << two;
  shell.expect("./isoline figures out --only curves-rosenbrock --tau 1e-3 --out loose");
  EXPECT_NE(read_text(shell.folder() / "loose" / "curves-rosenbrock.svg"), svg);
  shell.expect("./isoline figures out --methods nobody", {.exit_code = 1, .err = {"nobody"}});
}

TEST_F(Site, FiguresNameThePackageThatIsMissing) {
  const std::string python =
      "mkdir -p none && printf '#!/bin/sh\\nexec /usr/bin/python3 -S \"$@\"\\n' "
      "> none/python3 && chmod +x none/python3 && ";
  shell.expect(python + "PATH=$PWD/none:$PATH ./isoline figures out --only curves-rosenbrock",
               {.exit_code = 1, .err = {"python3-matplotlib"}});
  shell.expect(python + "PATH=$PWD/none:$PATH ./isoline export out --out curves.csv",
               {.exit_code = 1, .err = {"python3-pandas"}});
  if (has_program("pdflatex")) GTEST_SKIP() << "LaTeX is installed";
  shell.expect("./isoline figures out --only curves-rosenbrock --format pgf",
               {.exit_code = 1, .err = {"texlive-latex-base"}});
}

TEST_F(Site, LatexCompilesTheReportAndFigures) {
  if (!has_program("pdflatex")) GTEST_SKIP() << "pdflatex is not installed";
  shell.expect(
      "./isoline report out --out . && ./isoline figures out --format pgf,pdf --out drawn");
  const auto compile = [&](const std::string& name) {
    shell.expect("pdflatex -interaction=nonstopmode -halt-on-error " + name +
                 ".tex && pdflatex -interaction=nonstopmode -halt-on-error " + name + ".tex");
    const std::string log = read_text(shell.folder() / (name + ".log"));
    for (const char* fault : {"Overfull", "undefined", "multiply defined"})
      EXPECT_FALSE(contains(log, fault)) << name << ": " << log.substr(log.find(fault), 300);
  };
  compile("report");
  std::string figures;
  for (const auto& entry : fs::directory_iterator(shell.folder() / "drawn"))
    if (entry.path().extension() == ".pgf")
      figures += fmt::format("\\input{{drawn/{}}}\n\n", entry.path().filename().string());
  write_text(shell.folder() / "paper.tex",
             "\\documentclass[twocolumn]{article}\\usepackage{booktabs,graphicx,pgf}\n"
             "\\setlength{\\parindent}{0pt}\\raggedbottom\n"
             "\\begin{document}\n" +
                 figures +
                 "\\onecolumn\\def\\isolinefigures{drawn}\\def\\isolineonly{standings-table}"
                 "\\input{report}\n"
                 "Table~\\ref{tab:standings-table}.\n\\end{document}\n");
  compile("paper");
}

}  // namespace
}  // namespace isoline::benchmarks
