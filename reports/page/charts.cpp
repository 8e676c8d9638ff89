// The charts of problems and papers on the page.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/records/sheet.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// Of a kind, all have the scale of greys of y*, which comes first, or of x*, which comes last.
std::string pictures_html(const std::vector<Picture>& pictures) {
  std::string html;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Picture& like = pictures[i].kind == Picture::Kind::x
                              ? pictures.back()
                              : *std::ranges::find(pictures, pictures[i].kind, &Picture::kind);
    const auto [low, high] = std::ranges::minmax(like.values);
    std::string bytes;
    for (const Real value : pictures[i].values)
      bytes += static_cast<char>(
          std::lround(high > low ? 255 * std::clamp((value - low) / (high - low), 0.0, 1.0) : 0));
    html += fmt::format(
        "<figure>{}<figcaption>{} ({} to {})</figcaption></figure>",
        canvas_html(bytes, pictures[i].size, pictures[i].size, "grey", pictures[i].title),
        html_text(pictures[i].title), figure(low), figure(high));
  }
  return "<div class=pictures>" + html + "</div>";
}

std::string figure_html(const Comparison& c, const Figure& figure, std::size_t place) {
  Topic topic;
  for (std::size_t p = c.problems.size(); p-- > 0;)  // the first
    if (shown_spec(c.problems[p].spec) == shown_spec(figure.problem)) topic.problem = p;
  std::string drawn;
  if (!figure.pictures.empty()) {
    drawn = pictures_html(figure.pictures);
  } else {
    Drawing drawing = figure_drawing(c, figure);
    drawing.rest = std::to_string(place);
    drawn = drawing_svg(drawing) + names_html(drawing);
  }
  return fmt::format(
      "<figure class=\"plot panel{}\"{}><figcaption><b>{}</b> <span class=formula>{}</span><p "
      "class=reading>{}</p></figcaption>{}</figure>\n",
      figure.pictures.empty() ? "" : " wide", topic_attributes(topic), html_text(figure.title),
      html_text(figure.problem), html_text(figure.reading), drawn);
}

// Whether the curves are the same numbers: where a cost is the work, it has no chart of its own.
bool are_same(const CurveDrawing& one, const CurveDrawing& other) {
  const auto numbers = [](const PlotSeries& line) { return std::tie(line.x, line.y); };
  return one.vertical == other.vertical &&
         std::ranges::equal(one.drawing.plot.series, other.drawing.plot.series, {}, numbers,
                            numbers);
}

std::string levels_text(const Landscape& landscape) {
  if (landscape.spacing == "powers of two") return "at 2ⁱ for i = −5 … 7";
  if (landscape.spacing == "fifth root") return "in even steps of its fifth root";
  return "in even steps of its logarithm";
}

bool is_first(const std::vector<CurveDrawing>& all, std::size_t place) {
  return std::none_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(place),
                      [&](const CurveDrawing& before) { return are_same(before, all[place]); });
}

std::string curve_svg(const Comparison& c, const std::vector<CurveDrawing>& all, std::size_t place,
                      Real least_goal) {
  CurveDrawing one = all[place];
  one.drawing.attributes =
      fmt::format(" data-by={} data-vertical={}", name_of(one.by), one.vertical);
  for (std::size_t i = place + 1; i < all.size(); ++i)
    if (!all[i].is_own && are_same(one, all[i]))
      one.drawing.attributes += fmt::format(" data-also={}", name_of(all[i].by));
  if (!one.is_own) one.drawing.attributes += " hidden";
  one.drawing.rest = std::to_string(place);
  return drawing_svg(one.drawing, std::max(c.yardstick.tolerances[kTightest].tau, least_goal));
}

}  // namespace

std::string curves_html(const Comparison& c, std::size_t p) {
  const std::vector<CurveDrawing> all = curve_drawings(c, p);
  const auto own = std::ranges::find_if(all, &CurveDrawing::is_own);
  return own == all.end() ? ""
                          : curve_svg(c, all, static_cast<std::size_t>(own - all.begin()),
                                      c.problems[p].least_goal);
}

std::string curves_json(const Comparison& c, std::size_t p) {
  const std::vector<CurveDrawing> all = curve_drawings(c, p);
  std::string others, rest;
  const auto add = [&](const std::string& name, const Drawing& drawing) {
    rest += fmt::format("{}\"{}\":{}", rest.empty() ? "" : ",", name,
                        json_quoted(hidden_lines_svg(drawing)));
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].is_own && !is_first(all, i)) continue;
    if (!all[i].is_own) others += curve_svg(c, all, i, c.problems[p].least_goal);
    add(std::to_string(i), all[i].drawing);
  }
  for (const Plane& plane : planes_of(c, p)) add(plane.drawing.rest, plane.drawing);
  return fmt::format("{{\"charts\":{},\"rest\":{{{}}}}}", json_quoted(others), rest);
}

// Paths as the paper draws them: short runs with a point a step, long ones as lines.
std::string planes_html(const Comparison& c, std::size_t p) {
  const std::vector<Plane> planes = planes_of(c, p);
  if (planes.empty()) return "";
  std::string html;
  for (const Plane& plane : planes)
    html += fmt::format("<figure class=plane><figcaption><b>{}</b> {} {}</figcaption>{}</figure>",
                        plane.title, html_text(plane.reading),
                        html_text(plane.drawing.plot.caption), drawing_svg(plane.drawing));
  const Sheet& sheet = *c.problems[p].sheet;
  return fmt::format(
      "<div class=planes>{}</div><p class=legend>Thin lines: contours of the loss, {}. The paths "
      "are those of the run with the median work; points mark the steps of short runs. ○: start; "
      "●: solution in x, target in y.</p>",
      html, levels_text(sheet.landscape_x ? *sheet.landscape_x : *sheet.landscape_y));
}

std::string figure_lines_json(const Document& document) {
  return json_list(document.figures, [&](const Figure& figure) {
    return figure.pictures.empty()
               ? json_quoted(hidden_lines_svg(figure_drawing(document.comparison, figure)))
               : std::string("\"\"");
  });
}

std::string figures_html(const Document& document) {
  std::string html;
  for (std::size_t i = 0; i < document.figures.size(); ++i)
    html += figure_html(document.comparison, document.figures[i], i);
  return html.empty() ? "<p class=lead>No problem of this report has figures of its own.</p>"
                      : "<div class=panels>" + html + "</div>";
}

}  // namespace isoline::reports
