// The pages of a site: an index, and a page per suite, problem, method, paper and page of docs/.
// They consist of the parts of a report's page, and need no scripts.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

#include "core/results/advice.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string_view embedded_page_css();
std::string_view embedded_site_css();

namespace {

// An optimizer or a problem of one of the results.
struct Place {
  const SiteResults* results = nullptr;
  std::size_t index = 0;

  const Comparison& comparison() const { return results->document->comparison; }
};
using Places = std::map<std::string, std::vector<Place>>;  // by name without options

std::string name_of_spec(const std::string& spec) { return spec.substr(0, spec.find('[')); }

Places problems_of(const Site& site) {
  Places all;
  for (const SiteResults& results : site.results)
    for (std::size_t p = 0; p < results.document->comparison.problems.size(); ++p)
      all[name_of_spec(results.document->comparison.problems[p].spec)].push_back({&results, p});
  return all;
}

Places methods_of(const Site& site) {
  Places all;
  for (const SiteResults& results : site.results)
    for (std::size_t s = 0; s < results.document->comparison.optimizers.size(); ++s)
      all[results.document->comparison.optimizers[s].method].push_back({&results, s});
  return all;
}

std::string link(const std::string& address, const std::string& text) {
  return fmt::format("<a href=\"{}\">{}</a>", address, html_text(text));
}

std::string problem_address(const std::string& name) {
  return "problems/" + file_name_of(name) + ".html";
}
std::string method_address(const std::string& name) {
  return "methods/" + file_name_of(name) + ".html";
}
std::string paper_address(const Table& paper) {
  return "papers/" + file_name_of(paper.title) + ".html";
}
std::string suite_address(const SiteResults& results) {
  return "suites/" + file_name_of(results.name) + ".html";
}
std::string report_address(const SiteResults& results, const std::string& file = "index.html") {
  return "reports/" + file_name_of(results.name) + "/" + file;
}

// A page with the links of all others. `up` leads from its folder to the index.
std::string whole_page(const std::string& title, const std::string& body, const std::string& up,
                       const char* kind = "site") {
  std::string nav;
  for (const char* part : {"results", "problems", "methods", "papers", "docs"})
    nav += link(up + "index.html#" + part, words(std::string("site.") + part)) + "\n";
  return fmt::format(
      "<!doctype html>\n<html lang=en>\n<head>\n<meta charset=utf-8>\n<meta name=viewport "
      "content=\"width=device-width, initial-scale=1\">\n<meta name=color-scheme content=\"light "
      "dark\">\n<title>{0} · Isoline</title>\n<link rel=icon href=\"data:,\">\n<link rel=stylesheet "
      "href=\"{1}style.css\">\n</head>\n<body>\n<header class=top><div class=brand><span "
      "class=site-name><a href=\"{1}index.html\">Isoline</a></span> <p>{2}</p></div></header>\n<div "
      "class=bars><nav aria-label=Pages>{3}</nav></div>\n<main class=\"{4}\"><h1>{0}</h1>\n{5}"
      "</main>\n</body>\n</html>\n",
      html_text(title), up, html_text(words("page.what")), nav, kind, body);
}

// Leads links within a report to the pages of the site, or else to that report.
std::string relinked(std::string_view html, const SiteResults& results, const std::string& up) {
  constexpr std::string_view kLink = "href=\"#", kProblem = "problem-", kMethod = "optimizer-";
  const Comparison& c = results.document->comparison;
  std::string out;
  for (std::size_t at; (at = html.find(kLink)) != html.npos;) {
    out += html.substr(0, at);
    html.remove_prefix(at + kLink.size());
    const std::string anchor(html.substr(0, html.find('"')));
    html.remove_prefix(anchor.size());
    std::string address = report_address(results) + "#" + anchor;
    if (anchor.starts_with(kProblem))
      address = problem_address(
          name_of_spec(c.problems[std::stoul(anchor.substr(kProblem.size()))].spec));
    if (anchor.starts_with(kMethod))
      address = method_address(c.optimizers[std::stoul(anchor.substr(kMethod.size()))].method);
    out += "href=\"" + up + address;
  }
  return out.append(html);
}

// The lines that a report shows first, in the colours of their places, with their names below.
std::string drawing_html(const SiteResults& results, const NamedDrawing& one,
                         const std::string& up) {
  Drawing drawing = one.drawing;
  drawing.plot = shown_lines(drawing);
  drawing.shown.reset();
  std::string names;
  for (std::size_t i = 0; i < drawing.plot.series.size(); ++i) {
    drawing.plot.series[i].optimizer.reset();
    const std::string& method = drawing.plot.series[i].method;
    names +=
        fmt::format("<span class=c{}{}>{}{}</span> ", i % 8,
                    method.empty() ? "" : fmt::format(" style=\"--dash:{}\"", look_of(method).dash),
                    swatch(method), html_text(drawing.plot.series[i].name));
  }
  const std::string file = report_address(results, "figures/" + one.name);
  return fmt::format(
      "<figure class=plot><figcaption><b>{}.</b> {}</figcaption>{}<p class=\"legend names-of\">{}</p>"
      "<p class=legend>{} {} {}</p></figure>\n",
      html_text(drawing.plot.title), html_text(drawing.plot.reading), drawing_svg(drawing), names,
      link(up + suite_address(results), results.name), link(up + file + ".svg", "SVG"),
      link(up + file + ".csv", "CSV"));
}

std::string records_links(const SiteResults& results, const std::string& up) {
  return fmt::format("{} · {} · {}",
                     link(up + report_address(results) + "#runs", words("site.full")),
                     link(up + report_address(results, "report.csv"), words("site.runs-csv")),
                     link(up + report_address(results, "report.json"), words("site.runs-json")));
}

std::string records_html(const SiteResults& results, const std::string& up) {
  return "<p>" + records_links(results, up) + "</p>\n";
}

std::string heading(int level, const std::string& text) {
  return fmt::format("<h{0}>{1}</h{0}>\n", level, html_text(text));
}

// The best methods on a problem, as rows of the table of all cells of the report.
std::string best_methods_html(const Comparison& c, std::size_t p) {
  constexpr std::size_t kMostRows = 10;
  const std::vector<std::size_t> order = ranking(c, p);
  std::vector<std::pair<std::size_t, std::size_t>> cells;
  for (const std::size_t s : order)
    if (cells.size() < kMostRows) cells.emplace_back(p, s);
  if (cells.empty()) return "";
  Table table = cells_table(c, cells);
  table.caption = words("site.best-methods", cells.size(), order.size());
  return section_html({.title = c.problems[p].spec, .tables = {std::move(table)}});
}

// One row per setting of a problem: the best method, its work, and how many methods solve it.
std::string settings_html(const std::vector<Place>& places, std::size_t whole) {
  Table table = worded_table("site-settings", places.size(), whole);
  for (const Place& place : places) {
    const Comparison& c = place.comparison();
    const std::size_t p = place.index;
    const std::vector<std::size_t> order = ranking(c, p);
    const auto solved = std::ranges::count_if(
        order, [&](std::size_t s) { return c.cell(p, s).headline[kTightest].is_solved(); });
    TableCell setting = problem_name(c.problems[p]), results = place.results->name, best = "";
    setting.link = "../" + report_address(*place.results) + fmt::format("#problem-{}", p);
    results.link = "../" + suite_address(*place.results);
    if (!order.empty()) {
      best = optimizer_text(c, order[0]);
      best.link = "../" + method_address(c.optimizers[order[0]].method);
    }
    table.rows.push_back({setting, results, best,
                          order.empty() ? "" : matrix_text(c, c.cell(p, order[0]), kTightest),
                          fmt::format("{}/{}", solved, order.size())});
  }
  return section_html({.title = table.title, .tables = {std::move(table)}});
}

// Of a problem with many settings, the first ones are shown in full, and all of them in a table.
std::string problem_page(const std::string& name, const std::vector<Place>& places) {
  constexpr std::size_t kMostWhole = 12, kFirst = 4;
  const bool are_many = places.size() > kMostWhole;
  std::string html;
  for (const Place& place : std::span(places).first(are_many ? kFirst : places.size())) {
    const Comparison& c = place.comparison();
    const ProblemAxis& problem = c.problems[place.index];
    if (html.empty())
      html = problem_sheet_html(problem) + (are_many ? settings_html(places, kFirst) : "");
    html += fmt::format("<h2>{} · {}</h2>\n", html_text(shown_spec(problem.spec)),
                        link("../" + suite_address(*place.results), place.results->name));
    html += fmt::format("<p class=reading>{}</p>\n", prose_html(curve_reading(c, place.index)));
    for (const NamedDrawing& one : place.results->drawings)
      if (one.problem == place.index) html += drawing_html(*place.results, one, "../");
    html += relinked(best_methods_html(c, place.index), *place.results, "../");
    html += fmt::format("<p>{}: <code>isoline run --problem '{}'</code></p>\n",
                        html_text(words("site.try")), html_text(problem.spec));
    html += records_html(*place.results, "../");
  }
  return whole_page(name, html, "../");
}

std::string method_page(const std::string& name, const std::vector<Place>& places) {
  std::string html, facts, properties, options;
  for (const Place& place : places) {
    const Comparison& c = place.comparison();
    const OptimizerAxis& axis = c.optimizers[place.index];
    if (html.empty()) html = sheet_html(axis.sheet);
    if (properties.empty()) properties = properties_html(c, place.index);
    if (options.empty() && axis.sheet != nullptr)
      options = options_html(c, place.index, *axis.sheet);
    facts += fmt::format("<h2>{} · {}</h2>\n{}{}", html_text(shown_spec(axis.label)),
                         link("../" + suite_address(*place.results), place.results->name),
                         relinked(method_facts_html(c, place.index), *place.results, "../"),
                         records_html(*place.results, "../"));
  }
  html += options + heading(2, words("site.properties"));
  html += properties.empty() ? "<p class=lead>" + html_text(words("site.not-measured")) + "</p>\n"
                             : properties;
  return whole_page(name, html + facts, "../");
}

// The first method for each kind of simulator, and what it solves. Empty without an answer.
Table choices_table(const SiteResults& results) {
  const Comparison& c = results.document->comparison;
  Table table = worded_table("site-choices");
  std::size_t answers = 0;
  for (std::size_t level = 0; level < kDerivativeNames.size(); ++level) {
    Means means{.derivatives = static_cast<Derivatives>(level)};
    auto& row = table.rows.emplace_back();
    row.emplace_back(means_text(means));
    for (const auto& [least, most] : kSizeClasses) {
      means.least_unknowns = least, means.most_unknowns = most;
      const Advice advice = advise(c, means);
      TableCell& cell = row.emplace_back("");
      if (advice.ranked.empty()) continue;
      const Advised& first = advice.ranked[0];
      ++answers;
      cell.text = shown_spec(c.optimizers[first.optimizer].name_of_all());
      cell.link = "../" + method_address(c.optimizers[first.optimizer].method);
      cell.remark = first.work < kNever
                        ? words("site.choice", first.solved, advice.settings.size(), first.work)
                        : words("site.choice-some", first.solved, advice.settings.size());
    }
  }
  if (answers == 0) table.rows.clear();
  return table;
}

// Those tables that have an answer, by the names of the results.
using Choices = std::map<std::string, Table>;
Choices choices_of(const Site& site) {
  Choices all;
  for (const SiteResults& results : site.results)
    if (Table table = choices_table(results); !table.rows.empty())
      all[results.name] = std::move(table);
  return all;
}

std::string suite_page(const SiteResults& results, const Choices& choices) {
  const Document& document = *results.document;
  std::string html = fmt::format("<p class=lead>{}</p>\n", html_text(document.headline));
  if (!document.incomplete.empty())
    html += fmt::format("<p class=alert>{}</p>\n", html_text(document.incomplete));
  html += records_html(results, "../");
  for (const NamedDrawing& one : results.drawings)
    if (one.name == "profile-plot" || &one == &results.drawings.front()) {
      html += drawing_html(results, one, "../");
      break;
    }
  if (const auto found = choices.find(results.name); found != choices.end())
    html += section_html({.title = found->second.title, .tables = {found->second}});
  for (const char* id : {"standings", "problems", "learned"}) {
    const Section& section = document.section(id);
    if (!section.is_empty())
      html += heading(2, section.title) + relinked(section_html(section), results, "../");
  }
  return whole_page(results.name, html, "../");
}

// One table of papers_section(), in the order of the paper's figures. The verdict leads to the
// evidence, where results have it.
std::string paper_page(const Site& site, const Table& claims) {
  std::vector<std::size_t> order(claims.rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return claims.rows[i][1].text; });
  Table table = claims;
  for (std::size_t i = 0; i < order.size(); ++i) {
    table.rows[i] = claims.rows[order[i]];
    table.row_topics[i] = claims.row_topics[order[i]];
  }
  for (std::size_t i = 0; i < table.rows.size() && i < table.row_topics.size(); ++i)
    for (const SiteResults& results : site.results)
      for (const Judgement& claim : results.document->claims)
        if (claim.id == table.row_topics[i].claim)
          table.rows[i].back().link = "../" + report_address(results) + "#claim-" + claim.id;
  const std::string title = table.title;
  table.title.clear();
  return whole_page(title, section_html({.title = title, .tables = {std::move(table)}}), "../",
                    "site paper");
}

// "Which options?" as GitHub names it: "which-options".
std::string anchor_of(std::string_view heading) {
  std::string out;
  bool is_tag = false;
  for (const char letter : heading) {
    const auto byte = static_cast<unsigned char>(letter);
    if (letter == '<') is_tag = true;
    if (!is_tag && (std::isalnum(byte) != 0 || letter == '-' || letter == '_' || byte >= 0x80))
      out += static_cast<char>(byte < 0x80 ? std::tolower(byte) : byte);
    if (!is_tag && letter == ' ') out += '-';
    if (letter == '>') is_tag = false;
  }
  return out;
}

// A link to a page of docs/ leads to its page here; one to another file of the tree is left out.
std::string doc_address(const Site& site, const std::string& address) {
  if (address.starts_with('#') || address.find("://") != address.npos) return address;
  const std::size_t end = address.find(".md");
  if (end == address.npos || !site.docs.contains(address.substr(0, end))) return "";
  return address.substr(0, end) + ".html" + address.substr(end + 3);
}

// The text of a page of docs/ after its title, with anchors, wide tables that scroll, and links.
std::string doc_body(const Site& site, std::string_view html) {
  std::string out;
  std::map<std::string, int> headings;
  bool is_linked = false;
  const auto starts = [&](std::string_view tag) { return html.starts_with(tag); };
  while (!html.empty()) {
    if (html[0] != '<') {
      const std::size_t text = std::min(html.find('<'), html.size());
      out += html.substr(0, text);
      html.remove_prefix(text);
      continue;
    }
    const std::size_t end = std::min(html.find('>'), html.size() - 1) + 1;
    std::string tag(html.substr(0, end));
    if (starts("<a href=\"")) {
      constexpr std::size_t kBefore = 9;
      const std::string address =
          doc_address(site, tag.substr(kBefore, tag.find('"', kBefore) - kBefore));
      is_linked = !address.empty();
      tag = is_linked ? "<a href=\"" + address + "\">" : "";
    } else if (starts("</a>") && !is_linked) {
      tag.clear();
    } else if (starts("<img ")) {  // pictures stand in the tree alone
      tag.clear();
    } else if (starts("<h2>") || starts("<h3>")) {
      std::string anchor = anchor_of(html.substr(end, html.find("</h") - end));
      if (const int earlier = headings[anchor]++; earlier > 0)
        anchor += fmt::format("-{}", earlier);
      tag = fmt::format("<h{} id=\"{}\">", html[2], anchor);
    } else if (starts("<table>")) {
      tag = "<div class=scroll tabindex=0 role=group aria-label=Table><table>";
    } else if (starts("</table>")) {
      tag += "</div>";
    }
    out += tag;
    html.remove_prefix(end);
  }
  return out;
}

std::string doc_title(const std::string& html) {
  const std::size_t begin = html.find("<h1>"), end = html.find("</h1>");
  return begin != 0 || end == html.npos ? "" : html.substr(4, end - 4);
}

// What results show as a whole: their ranking if it covers several problems, the best on learned
// problems, and certified digits.
std::vector<std::string> sentences_of(const Document& document) {
  const Comparison& c = document.comparison;
  std::vector<std::string> sentences;
  const std::vector<Reading>& ranking = document.section("standings").readings;
  if (c.decision && c.decision->families > 1 && !ranking.empty())
    sentences.push_back(ranking[0].text);
  for (const std::string& one : learned_sentences(c)) sentences.push_back(one);
  if (const Table table = certified_table(c); !table.reading.empty())
    sentences.push_back(table.reading);
  return sentences;
}

// Six findings: the first sentences of up to three results, then a decided claim of each paper.
std::string findings_html(const Site& site, const Section& papers) {
  constexpr std::size_t kFindings = 6, kOfResults = 3;
  std::vector<std::string> items;
  std::vector<std::pair<const SiteResults*, std::string>> later;
  for (const SiteResults& results : site.results)
    for (std::string& sentence : sentences_of(*results.document)) {
      const bool is_first = later.empty() || later.back().first != &results;
      later.emplace_back(&results, "");
      std::string item = link(suite_address(results), results.name) + ": " + html_text(sentence);
      if (is_first && items.size() < kOfResults)
        items.push_back(std::move(item));
      else
        later.back().second = std::move(item);
    }
  for (const Table& paper : papers.tables) {
    const Judgement* claim = nullptr;  // the first, if possible with a published value
    bool has_value = false;
    for (const Judgement& one : site.claims) {
      if (one.paper != paper.title || !is_decided(one.verdict) || one.is_verification ||
          !one.measured || has_value)
        continue;
      has_value = one.band && std::isfinite(one.band->low) && std::isfinite(one.band->high);
      if (claim == nullptr || has_value) claim = &one;
    }
    if (claim != nullptr && items.size() < kFindings)
      items.push_back(link(paper_address(paper), paper.title) + ": " +
                      html_text(words("site.claim", claim->sentence, claim->published,
                                      figure(claim->measured->value), verdict_text(*claim))));
  }
  for (auto& [results, item] : later)
    if (!item.empty() && items.size() < kFindings) items.push_back(std::move(item));
  std::string html;
  for (const std::string& item : items) html += "<li>" + item + "</li>\n";
  return "<ul>\n" + html + "</ul>\n";
}

// The way to the answers of three readers: an author of a paper, an owner of a simulator, and one
// who doubts a figure.
std::string start_html(const Site& site, const Choices& choices) {
  std::string suites, runs;
  for (const SiteResults& results : site.results) {
    if (choices.contains(results.name))
      suites += " " + link(suite_address(results) + "#site-choices", results.name);
    runs += " " + link(report_address(results) + "#runs", results.name);
  }
  std::string html = fmt::format("<li>{} {}</li>\n", html_text(words("site.start-paper")),
                                 link("#papers", words("site.papers")));
  html += fmt::format("<li>{}{}", html_text(words("site.start-simulator")), suites);
  for (const char* page : {"bring-a-simulator", "calibrate-a-simulator"})
    if (const auto doc = site.docs.find(page); doc != site.docs.end())
      html += fmt::format(" · <a href=\"docs/{}.html\">{}</a>", page, doc_title(doc->second));
  return fmt::format("<ul>\n{}</li>\n<li>{}{}</li>\n</ul>\n", html,
                     html_text(words("site.start-doubt")), runs);
}

// Six drawings, of all results in turn.
std::string pictures_html(const Site& site) {
  constexpr std::size_t kPictures = 6;
  std::string html;
  std::size_t count = 0;
  for (std::size_t i = 0; i < kPictures; ++i)
    for (const SiteResults& results : site.results)
      if (i < results.drawings.size() && count++ < kPictures)
        html += drawing_html(results, results.drawings[i], "");
  return "<div class=\"plots six\">\n" + html + "</div>\n";
}

// Links under the headings of their groups.
using Groups = std::map<std::string, std::string>;
std::string groups_html(const Groups& groups) {
  std::string html;
  for (const auto& [group, links] : groups)
    html += heading(3, group) + "<ul class=cards>\n" + links + "</ul>\n";
  return html;
}

std::string index_page(const Site& site, const Places& problems, const Places& methods,
                       const Section& papers, const Choices& choices) {
  const auto part = [](const char* id) {
    return fmt::format("<h2 id={}>{}</h2>\n", id, html_text(words(std::string("site.") + id)));
  };
  std::string html = "<p class=lead>" + html_text(words("site.lead")) + "</p>\n";
  html += start_html(site, choices) + part("findings") + findings_html(site, papers) +
          part("pictures") + pictures_html(site);
  html += part("results") + "<ul>\n";
  for (const SiteResults& results : site.results)
    html += fmt::format("<li>{}: {} · {}</li>\n", link(suite_address(results), results.name),
                        html_text(results.document->headline), records_links(results, ""));
  html += "</ul>\n" + part("problems");
  Groups groups, kinds;
  for (const auto& [name, places] : problems)
    groups[places[0].comparison().problems[places[0].index].group()] +=
        "<li>" + link(problem_address(name), name) + "</li>\n";
  for (const auto& [name, places] : methods)
    kinds[kind_title(places[0].comparison().optimizers[places[0].index].mathematics())] +=
        "<li>" + link(method_address(name), name) + "</li>\n";
  html += groups_html(groups) + part("methods") + groups_html(kinds) + part("papers");
  html += "<p class=lead>" + html_text(words("site.papers-lead")) + "</p>\n<ul>\n";
  for (const Table& paper : papers.tables)
    html += "<li>" + link(paper_address(paper), paper.title) + "</li>\n";
  html += "<li>" + link("papers/items.html", words("site.items")) + "</li>\n</ul>\n" +
          part("docs") + "<ul class=cards>\n";
  for (const auto& [name, text] : site.docs)
    html += fmt::format("<li><a href=\"docs/{}.html\">{}</a></li>\n", name, doc_title(text));
  return whole_page("Optimizers on inverse problems", html + "</ul>\n", "");
}

}  // namespace

std::map<std::string, std::string> site_pages(const Site& site) {
  const Places problems = problems_of(site), methods = methods_of(site);
  const Section papers = papers_section(site.claims);
  const Choices choices = choices_of(site);
  std::map<std::string, std::string> pages = {
      {"index.html", index_page(site, problems, methods, papers, choices)},
      {"style.css", std::string(embedded_page_css()) + std::string(embedded_site_css())},
      {"papers/items.html", whole_page(words("site.items"), section_html(site.items), "../")}};
  for (const auto& [name, places] : problems)
    pages[problem_address(name)] = problem_page(name, places);
  for (const auto& [name, places] : methods)
    pages[method_address(name)] = method_page(name, places);
  for (const Table& paper : papers.tables) pages[paper_address(paper)] = paper_page(site, paper);
  for (const SiteResults& results : site.results)
    pages[suite_address(results)] = suite_page(results, choices);
  for (const auto& [name, text] : site.docs) {
    const std::size_t end = text.find("</h1>");
    pages["docs/" + name + ".html"] =
        whole_page(doc_title(text), doc_body(site, end == text.npos ? text : text.substr(end + 5)),
                   "../", "site text-page");
  }
  return pages;
}

}  // namespace isoline::reports
