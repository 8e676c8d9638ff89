// The first tab: the verdict, what is settled and what is not, and how the runs ended.
#include <fmt/format.h>

#include "reports/formats/escape.h"
#include "reports/page/page.h"
#include "reports/sections/sections.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

std::string alerts_html(const Document& document) {
  const Comparison& c = document.comparison;
  std::string html;
  if (!document.incomplete.empty())
    html += fmt::format("<p class=alert role=alert><b>Incomplete.</b> {}</p>\n",
                        html_text(document.incomplete));
  const std::size_t unread = c.study->unreadable.size();
  if (!c.failures.empty() || unread > 0)
    html += fmt::format(
        "<p class=alert><b>{} failed</b>{} — <a href=\"#failures\">which, and why</a></p>\n",
        counted(c.failures.size(), "run"),
        unread > 0 ? fmt::format(", {} unreadable", counted(unread, "file")) : "");
  return html;
}

// A sentence decides; all that these runs say opens.
std::string verdict_html(const Comparison& c) {
  const std::vector<std::string> sentences = verdict(c);
  if (sentences.empty()) return "";
  std::string html = fmt::format("<p class=verdict>{}</p>\n", html_text(short_verdict(c)));
  html += "<details><summary>All that these runs say</summary>";
  for (const std::string& sentence : sentences)
    html += fmt::format("<p class=lead>{}</p>\n", html_text(sentence));
  return html + "</details>\n";
}

std::string settled_html(const Comparison& c) {
  std::string html = "<dl class=settled>";
  for (const Reading& reading : settled_readings(c))
    html += fmt::format("<dt>{}<dd>{}", html_text(reading.title), html_text(reading.text));
  return html + "</dl>\n";
}

}  // namespace

std::string overview_html(const Document& document) {
  const Comparison& c = document.comparison;
  return alerts_html(document) + verdict_html(c) + settled_html(c);
}

std::string endings_html(const Comparison& c) {
  std::string html =
      fmt::format("<li><b>{}<small>/{}</small></b>runs complete</li>", c.answered, c.planned);
  for (const auto& [status, count] : c.statuses)
    html += fmt::format("<li class=\"{}\"><b>{}</b>{}<small>{}</small></li>",
                        is_failure(status) ? "bad" : "", count, status_meaning(status),
                        name_of(status));
  return "<ul class=tiles>" + html + "</ul>";
}

std::string marks_html(const OptimizerAxis& axis) {
  std::string marks;
  if (!axis.privileges.empty())
    marks = fmt::format("<sup><a href=\"#privileges\" title=\"given: {}\">†</a></sup>",
                        html_text(joined(axis.privileges)));
  if (axis.is_imported) marks += "<sup title=\"imported: by its own figures\">§</sup>";
  return marks;
}

}  // namespace isoline::reports
