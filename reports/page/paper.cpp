// Drawings for papers: one geometry as SVG with its colours in each element, as PGF for LaTeX, and
// the points of the lines as CSV. Lengths are in points of 1/72.27 inch.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kWidth = 229,
               kAreaHeight = 124;  // a column of an article, the narrowest of journals
constexpr Real kLeft = 36, kTop = 15, kRight = 8, kBelow = 25, kRow = 9.5;
constexpr Real kSmall = 7, kText = 8;  // sizes of letters
constexpr std::string_view kInk = "1C2024", kGrid = "D5D8DC", kGoal = "A8201A", kTau = "5D666F";
// Okabe and Ito (2008), as on the page.
constexpr std::string_view kColours[] = {"0072B2", "D55E00", "009E73", "B85A90",
                                         "B57700", "2F8FC9", "5B4BB5", "555555"};
constexpr std::string_view kDashes[] = {"", "4 2", "1 2", "5 2 1 2"};

struct PaperPoint {
  Real x = 0, y = 0;  // y downwards
};

// What a figure is made of, from the back to the front.
struct PaperMark {
  enum class Kind { line, area, dots, text };
  Kind kind = Kind::line;
  std::vector<PaperPoint> points;
  std::string_view colour = kInk, dash = "";
  Real size = 0.5;   // the width of a line, the radius of dots, the height of letters
  char align = 'l';  // of a text: l, m or r
  std::string text = {};
  bool is_inside = false;  // cut at the edges of the area
};

struct PaperFigure {
  Frame frame;
  Real height = 0;
  std::vector<PaperMark> marks;
};

// Runs of finite points on the paper, with the corners of steps.
std::vector<std::vector<PaperPoint>> runs_of(const Frame& frame, const std::vector<Real>& x,
                                             const std::vector<Real>& y, Join join) {
  std::vector<std::vector<PaperPoint>> runs(1);
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (std::isnan(x[i]) || std::isnan(y[i])) {
      if (!runs.back().empty()) runs.emplace_back();
      continue;
    }
    const PaperPoint next{frame.x(x[i]), frame.y(y[i])};
    if (join == Join::steps && !runs.back().empty())
      runs.back().push_back({next.x, runs.back().back().y});
    runs.back().push_back(next);
  }
  if (runs.back().empty()) runs.pop_back();
  return runs;
}

void add_axes(PaperFigure& picture, const Plot& plot) {
  const Frame& frame = picture.frame;
  auto& marks = picture.marks;
  const bool is_share = plot.kind == Plot::Kind::steps;
  for (const Real tick : ticks_of(frame.window.x_low, frame.window.x_high, frame.is_log_x)) {
    const Real x = frame.x(tick);
    marks.push_back({.points = {{x, frame.top}, {x, frame.bottom()}}, .colour = kGrid});
    marks.push_back({.kind = PaperMark::Kind::text,
                     .points = {{x, frame.bottom() + 8.5}},
                     .size = kSmall,
                     .align = 'm',
                     .text = tick_text(tick)});
  }
  for (const Real tick : ticks_of(frame.window.y_low, frame.window.y_high, frame.is_log_y)) {
    const Real y = frame.y(tick);
    marks.push_back({.points = {{frame.left, y}, {frame.right(), y}}, .colour = kGrid});
    marks.push_back({.kind = PaperMark::Kind::text,
                     .points = {{frame.left - 3, y + 2.5}},
                     .size = kSmall,
                     .align = 'r',
                     .text = is_share ? percent(tick) : tick_text(tick)});
  }
  marks.push_back({.kind = PaperMark::Kind::text,
                   .points = {{frame.left + frame.width / 2, frame.bottom() + 19}},
                   .size = kText,
                   .align = 'm',
                   .text = plot.x_label});
  marks.push_back({.kind = PaperMark::Kind::text,
                   .points = {{2, frame.top - 6}},
                   .size = kText,
                   .text = plot.y_label});
}

void add_line(PaperFigure& picture, const Drawing& drawing, const PlotSeries& line,
              std::size_t place) {
  const std::string_view colour = kColours[place % std::size(kColours)];
  const std::string_view dash = kDashes[place % std::size(kDashes)];
  const bool is_stair = drawing.plot.kind == Plot::Kind::steps;
  for (std::vector<PaperPoint>& run : runs_of(picture.frame, line.x, line.y, drawing.join)) {
    if (is_stair) run.push_back({picture.frame.right(), run.back().y});
    const bool are_dots = drawing.join == Join::none || run.size() == 1;
    picture.marks.push_back({.kind = are_dots ? PaperMark::Kind::dots : PaperMark::Kind::line,
                             .points = std::move(run),
                             .colour = colour,
                             .dash = dash,
                             .size = 1,
                             .is_inside = true});
  }
}

void add_published(PaperFigure& picture, const PlotSeries& goal) {
  if (goal.x.size() > 1 && !goal.y.empty()) {
    for (std::vector<PaperPoint>& run : runs_of(picture.frame, goal.x, goal.y, Join::straight))
      picture.marks.push_back(
          {.points = std::move(run), .colour = kGoal, .dash = "3 3", .is_inside = true});
    return;
  }
  if (goal.x.size() != 1 || goal.y.empty()) return;
  const Real x = picture.frame.x(goal.x[0]);
  if (!goal.low.empty() && std::isfinite(goal.low[0]) && std::isfinite(goal.high[0]))
    picture.marks.push_back(
        {.points = {{x, picture.frame.y(goal.low[0])}, {x, picture.frame.y(goal.high[0])}},
         .colour = kGoal,
         .size = 1.5,
         .is_inside = true});
  picture.marks.push_back({.kind = PaperMark::Kind::dots,
                           .points = {{x, picture.frame.y(goal.y[0])}},
                           .colour = kGoal,
                           .size = 2,
                           .is_inside = true});
}

// The names of the lines below, in two columns where they are short.
void add_names(PaperFigure& picture, const Plot& shown) {
  constexpr std::size_t kShort = 22, kLong = 50;
  constexpr Real kSwatch = 16;
  const bool is_narrow = std::ranges::all_of(
      shown.series, [](const PlotSeries& line) { return line.name.size() <= kShort; });
  const std::size_t columns = is_narrow ? 2 : 1;
  for (std::size_t i = 0; i < shown.series.size(); ++i) {
    const Real x = 4 + Real(i % columns) * kWidth / 2;
    const Real y = picture.height + Real(i / columns) * kRow + 4;
    std::string name = shown.series[i].name;
    if (name.size() > kLong) name = std::string(cut(name, kLong - 1)) + "…";
    picture.marks.push_back({.points = {{x, y - 2.5}, {x + kSwatch, y - 2.5}},
                             .colour = kColours[i % std::size(kColours)],
                             .dash = kDashes[i % std::size(kDashes)],
                             .size = 1});
    picture.marks.push_back({.kind = PaperMark::Kind::text,
                             .points = {{x + kSwatch + 4, y}},
                             .size = kSmall,
                             .text = std::move(name)});
  }
  picture.height += kRow * Real((shown.series.size() + columns - 1) / columns);
}

PaperFigure picture_of(const Drawing& drawing) {
  const Plot shown = shown_lines(drawing);
  PaperFigure picture{
      .frame = framed(
          drawing,
          {.left = kLeft, .top = kTop, .width = kWidth - kLeft - kRight, .height = kAreaHeight}),
      .height = kTop + kAreaHeight + kBelow};
  add_axes(picture, shown);
  for (const PlotSeries& line : drawing.ground)
    for (std::vector<PaperPoint>& run : runs_of(picture.frame, line.x, line.y, Join::straight))
      picture.marks.push_back(
          {.points = std::move(run), .colour = kTau, .dash = "1 2", .is_inside = true});
  for (std::size_t i = shown.series.size(); i-- > 0;)  // the first on top
    add_line(picture, drawing, shown.series[i], i);
  for (const PlotSeries& goal : shown.published) add_published(picture, goal);
  add_names(picture, shown);
  return picture;
}

std::string mark_svg(const PaperMark& mark) {
  if (mark.kind == PaperMark::Kind::text)
    return fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"#{}\">{}</text>\n",
        mark.points[0].x, mark.points[0].y, mark.size,
        mark.align == 'l'   ? "start"
        : mark.align == 'm' ? "middle"
                            : "end",
        mark.colour, html_text(mark.text));
  std::string out;
  const char* clip = mark.is_inside ? " clip-path=\"url(#area)\"" : "";
  if (mark.kind == PaperMark::Kind::dots) {
    for (const PaperPoint& at : mark.points)
      out += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\" fill=\"#{}\"{}/>\n", at.x,
                         at.y, mark.size, mark.colour, clip);
    return out;
  }
  for (const PaperPoint& at : mark.points)
    out += fmt::format("{}{:.2f} {:.2f}", out.empty() ? "M" : "L", at.x, at.y);
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"#{}\" stroke-width=\"{}\"{}{}/>\n", out, mark.colour,
      mark.size, mark.dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", mark.dash), clip);
}

// "4 2" is "{4pt}{2pt}".
std::string pgf_dash(std::string_view dash) {
  std::string out;
  for (const char letter : dash)
    if (letter != ' ') out += fmt::format("{{{}pt}}", letter);
  return out;
}

std::string mark_pgf(const PaperMark& mark, Real height) {
  const auto place = [&](const PaperPoint& at) {
    return fmt::format("\\pgfqpoint{{{:.2f}pt}}{{{:.2f}pt}}", at.x, height - at.y);
  };
  std::string out = fmt::format("\\definecolor{{isoline}}{{HTML}}{{{}}}%\n", mark.colour);
  if (mark.kind == PaperMark::Kind::text)
    return out + fmt::format(
                     "\\pgftext[x={:.2f}pt,y={:.2f}pt,base{}]"
                     "{{\\color{{isoline}}\\fontsize{{{}}}{{{}}}\\selectfont {}}}%\n",
                     mark.points[0].x, height - mark.points[0].y,
                     mark.align == 'l'   ? ",left"
                     : mark.align == 'm' ? ""
                                         : ",right",
                     mark.size, mark.size + 1, latex_words(mark.text));
  if (mark.kind == PaperMark::Kind::dots) {
    out += "\\pgfsetfillcolor{isoline}%\n";
    for (const PaperPoint& at : mark.points)
      out += fmt::format("\\pgfpathcircle{{{}}}{{{}pt}}%\n", place(at), mark.size);
    return out + "\\pgfusepath{fill}%\n";
  }
  out += fmt::format(
      "\\pgfsetstrokecolor{{isoline}}\\pgfsetlinewidth{{{}pt}}"
      "\\pgfsetdash{{{}}}{{0pt}}%\n",
      mark.size, pgf_dash(mark.dash));
  for (std::size_t i = 0; i < mark.points.size(); ++i)
    out += fmt::format("\\pgfpath{}to{{{}}}%\n", i == 0 ? "move" : "line", place(mark.points[i]));
  return out + "\\pgfusepath{stroke}%\n";
}

}  // namespace

std::string paper_svg(const Drawing& drawing) {
  const PaperFigure picture = picture_of(drawing);
  const Frame& frame = picture.frame;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}pt\" height=\"{1:.1f}pt\" viewBox=\"0 0 "
      "{0} {1:.1f}\" font-family=\"sans-serif\"><title>{2}</title>\n<clipPath id=\"area\"><rect "
      "x=\"{3}\" y=\"{4}\" width=\"{5}\" height=\"{6}\"/></clipPath>\n",
      kWidth, picture.height, html_text(drawing.plot.title), frame.left, frame.top, frame.width,
      frame.height);
  for (const PaperMark& mark : picture.marks) svg += mark_svg(mark);
  return svg + "</svg>\n";
}

std::string paper_pgf(const Drawing& drawing) {
  const PaperFigure picture = picture_of(drawing);
  const Frame& frame = picture.frame;
  std::string pgf = fmt::format(
      "% \\usepackage{{pgf}}\n\\begin{{pgfpicture}}%\n\\pgfpathrectangle{{\\pgfpointorigin}}"
      "{{\\pgfqpoint{{{}pt}}{{{:.1f}pt}}}}\\pgfusepath{{use as bounding box}}%\n",
      kWidth, picture.height);
  bool is_inside = false;
  const auto set_inside = [&](bool inside) {
    if (inside && !is_inside)
      pgf += fmt::format(
          "\\begin{{pgfscope}}\\pgfpathrectangle{{\\pgfqpoint{{{}pt}}{{{:.1f}pt}}}}"
          "{{\\pgfqpoint{{{}pt}}{{{}pt}}}}\\pgfusepath{{clip}}%\n",
          frame.left, picture.height - frame.bottom(), frame.width, frame.height);
    if (!inside && is_inside) pgf += "\\end{pgfscope}%\n";
    is_inside = inside;
  };
  for (const PaperMark& mark : picture.marks) {
    set_inside(mark.is_inside);
    pgf += mark_pgf(mark, picture.height);
  }
  set_inside(false);
  return pgf + "\\end{pgfpicture}%\n";
}

std::string points_csv(const Drawing& drawing) {
  std::string csv = "line,x,y,low,high\r\n";
  const auto at = [](const std::vector<Real>& values, std::size_t i) {
    return i < values.size() && !std::isnan(values[i]) ? fmt::format("{}", values[i]) : "";
  };
  const auto add = [&](const PlotSeries& line, const std::string& name) {
    for (std::size_t i = 0; i < line.x.size(); ++i)
      csv += fmt::format("{},{},{},{},{}\r\n", csv_field(name), at(line.x, i), at(line.y, i),
                         at(line.low, i), at(line.high, i));
  };
  for (const PlotSeries& line : drawing.plot.series) add(line, line.name);
  for (const PlotSeries& goal : drawing.plot.published)
    add(goal, words("figures.published", goal.name));
  return csv;
}

}  // namespace isoline::reports
