// Axes and lines as SVG; colours and dashes are in page.css.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/text.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr Real kArea = 5'000, kBeyond = 4;  // lines go as many times the area beyond it

Real share_of(Real value, Real low, Real high, bool is_log) {
  if (!(high > low) || std::isnan(value) || (is_log && !(value > 0))) return 0;
  const Real share =
      is_log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return std::clamp(share, -kBeyond, kBeyond);
}

}  // namespace

std::string tick_text(Real value) {
  constexpr Real kInFull = 9999;
  if (value <= kInFull) return figure(value);
  const Real power = std::floor(std::log10(value) + 1e-9);
  return fmt::format("{:.2g}e{:.0f}", value / std::pow(10.0, power), power);
}

Real Frame::x(Real value) const {
  return left + width * share_of(value, window.x_low, window.x_high, is_log_x);
}
Real Frame::y(Real value) const {
  return bottom() - height * share_of(value, window.y_low, window.y_high, is_log_y);
}

std::vector<Real> ticks_of(Real low, Real high, bool is_logarithmic) {
  constexpr Real kMost = 8;
  constexpr std::ptrdiff_t kFewest = 3;
  constexpr int kBound =
      64;  // of any axis: where a step is lost to rounding, none goes on for ever
  std::vector<Real> ticks;
  if (is_logarithmic) {
    const Real factor = std::pow(10.0, std::max(1.0, std::ceil(std::log10(high / low) / kMost)));
    Real tick = std::pow(factor, std::ceil(std::log(low) / std::log(factor) - 1e-9));
    while (tick <= high * (1 + 1e-9) && std::ssize(ticks) < kBound) {
      ticks.push_back(tick);
      tick *= factor;
    }
    if (std::ssize(ticks) >= kFewest || low < std::numeric_limits<Real>::min()) return ticks;
    ticks.clear();
    for (Real power = std::pow(10.0, std::floor(std::log10(low)));
         power <= high && std::ssize(ticks) + 3 < kBound; power *= 10)
      for (const Real digit : {1, 2, 5})
        if (digit * power >= low * (1 - 1e-9) && digit * power <= high * (1 + 1e-9))
          ticks.push_back(digit * power);
    if (std::ssize(ticks) >= kFewest) return ticks;
    ticks.clear();
  }
  const Real rough = (high - low) / kMost, power = std::pow(10.0, std::floor(std::log10(rough)));
  Real step = 10 * power;
  for (const Real digit : {5, 2, 1})
    if (digit * power >= rough) step = digit * power;
  const Real first = std::ceil(low / step - 1e-9);
  for (int i = 0; i < kBound && (first + i) * step <= high + 1e-9 * step; ++i)
    ticks.push_back((first + i) * step + 0.0);  // no −0
  return ticks;
}

std::string x_axis(const Frame& frame, const std::string& label) {
  std::string grid, texts;
  for (const Real tick : ticks_of(frame.window.x_low, frame.window.x_high, frame.is_log_x)) {
    grid += fmt::format("M{:.1f} {:.0f}V{:.0f}", frame.x(tick), frame.top, frame.bottom());
    texts += fmt::format("<text x={:.1f} y={:.0f}>{}</text>", frame.x(tick), frame.bottom() + 15,
                         tick_text(tick));
  }
  return fmt::format(
      "<path class=grid d=\"{}\"/><g text-anchor=middle>{}</g>"
      "<text x={:.0f} y={:.0f} dy=2.5em text-anchor=middle>{}</text>",
      grid, texts, frame.left + frame.width / 2, frame.bottom(), html_text(label));
}

std::string y_axis(const Frame& frame, const std::string& label, bool is_share) {
  std::string grid, texts;
  for (const Real tick : ticks_of(frame.window.y_low, frame.window.y_high, frame.is_log_y)) {
    grid += fmt::format("M{:.0f} {:.1f}H{:.0f}", frame.left, frame.y(tick), frame.right());
    texts += fmt::format("<text x={:.0f} y={:.1f}>{}</text>", frame.left - 6, frame.y(tick) + 4,
                         is_share ? percent(tick) : tick_text(tick));
  }
  return fmt::format(
      "<path class=grid d=\"{}\"/><g text-anchor=end>{}</g><text x=4 y={:.0f} dy=-.7em>{}</text>",
      grid, texts, frame.top, html_text(label));
}

// What is filtered with an optimizer, a problem, a method or a claim.
std::string topic_attributes(const Topic& topic) {
  std::string tag;
  if (topic.optimizer) tag += fmt::format(" data-s={}", *topic.optimizer);
  if (topic.problem) tag += fmt::format(" data-p={}", *topic.problem);
  if (!topic.method.empty()) tag += fmt::format(" data-method=\"{}\"", html_text(topic.method));
  if (!topic.claim.empty()) tag += fmt::format(" data-claim=\"{}\"", html_text(topic.claim));
  return tag;
}

std::string swatch(const std::string& method) {
  const std::string mark =
      method.empty() ? "" : fmt::format("<path class=mark d=\"M12 4{}\"/>", look_of(method).shape);
  return fmt::format("<svg class=swatch><path d=\"M0 4h24\"/>{}</svg>", mark);
}

// Lines.

Frame framed(const Drawing& drawing, Frame frame) {
  const Plot& plot = drawing.plot;
  frame.is_log_x = plot.is_log_x;
  frame.is_log_y = plot.is_log_y;
  Window& window = frame.window;
  window = window_of(drawing);
  if (drawing.is_to_scale) {
    const Real unit = std::max((window.x_high - window.x_low) / frame.width,
                               (window.y_high - window.y_low) / frame.height);
    const Real x = (window.x_low + window.x_high) / 2, y = (window.y_low + window.y_high) / 2;
    window = {x - unit * frame.width / 2, x + unit * frame.width / 2, y - unit * frame.height / 2,
              y + unit * frame.height / 2};
  }
  return frame;
}

namespace {

constexpr Real kLeft = 62, kTop = 26, kBelow = 40, kNameWidth = 164;

// Narrow where names stand below, so that letters can be read on a telephone.
Frame frame_of(const Drawing& drawing) {
  const Real width = drawing.has_names ? 760 : 480, height = drawing.has_names ? 380 : 300;
  return framed(drawing, {.left = kLeft,
                          .top = kTop,
                          .width = width - kLeft - (drawing.has_names ? kNameWidth : 16),
                          .height = height - kTop - kBelow});
}

// The same window in the coordinates of the area.
Frame area_of(Frame frame) {
  frame.left = frame.top = 0;
  frame.width = frame.height = kArea;
  return frame;
}

// Relative and whole, since a page has many: "M1 2h3v4", with a gap where there is no number.
std::string path_of(const Frame& area, const std::vector<Real>& x, const std::vector<Real>& y,
                    Join join) {
  std::string path;
  std::int64_t last_x = 0, last_y = 0;
  bool is_down = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool is_number = !std::isnan(x[i]) && !std::isnan(y[i]);
    if (is_number) {
      const std::int64_t at_x = std::llround(area.x(x[i])), at_y = std::llround(area.y(y[i]));
      const std::int64_t across = at_x - last_x, up = at_y - last_y;
      if (!is_down || join == Join::none)
        path += fmt::format("M{} {}{}", at_x, at_y, join == Join::none ? "h0" : "");
      else if (join == Join::straight)
        path += fmt::format("l{}{}{}", across, up < 0 ? "" : " ", up);
      else
        path += (across != 0 ? fmt::format("h{}", across) : "") +
                (up != 0 ? fmt::format("v{}", up) : "");
      last_x = at_x;
      last_y = at_y;
    }
    is_down = is_number;
  }
  return path;
}

std::string band_of(const Frame& area, const PlotSeries& line, Join join) {
  std::vector<Real> x, high, back_x, back;  // a stair back from its end turns before its steps
  for (std::size_t i = 0; i < line.low.size(); ++i) {
    if (std::isnan(line.low[i]) || std::isnan(line.high[i])) continue;
    if (join == Join::steps && !back.empty()) {
      back_x.push_back(line.x[i]);
      back.push_back(back.back());
    }
    back_x.push_back(line.x[i]);
    back.push_back(line.low[i]);
    x.push_back(line.x[i]);
    high.push_back(line.high[i]);
  }
  if (x.empty()) return "";
  std::ranges::reverse(back_x);
  std::ranges::reverse(back);
  if (join == Join::steps) {
    std::string way_back = path_of(area, back_x, back, Join::straight);
    way_back[0] = 'L';
    return fmt::format("<path class=band d=\"{}{}Z\"/>", path_of(area, x, high, join), way_back);
  }
  x.insert(x.end(), back_x.begin(), back_x.end());
  high.insert(high.end(), back.begin(), back.end());
  return fmt::format("<path class=band d=\"{}Z\"/>", path_of(area, x, high, Join::straight));
}

// What lies between the parts of a path.
std::string gaps_of(const Frame& area, const PlotSeries& line, Join join) {
  std::string path;
  for (std::size_t i = 1; i + 1 < line.y.size(); ++i)
    if (std::isnan(line.y[i]) && !std::isnan(line.y[i - 1]) && !std::isnan(line.y[i + 1]))
      path += path_of(area, {line.x[i - 1], line.x[i + 1]}, {line.y[i - 1], line.y[i + 1]}, join);
  return path.empty() ? "" : fmt::format("<path class=gap d=\"{}\"/>", path);
}

// Which line a button is of: of an optimizer in all drawings the same. A method that has one line
// alone has the colour that it has elsewhere.
std::string line_attributes(const Drawing& drawing, std::size_t place, std::string classes) {
  const PlotSeries& line = drawing.plot.series[place];
  if (!line.optimizer) classes += fmt::format("{}c{}", classes.empty() ? "" : " ", place % 8);
  std::string tag =
      fmt::format(" data-{}={}", line.optimizer ? "s" : "line", line.optimizer.value_or(place));
  if (!classes.empty()) tag += fmt::format(" class=\"{}\"", classes);
  if (line.optimizer || line.method.empty()) return tag;
  tag += fmt::format(" style=\"--dash:{}\"", look_of(line.method).dash);
  if (std::ranges::count(drawing.plot.series, line.method, &PlotSeries::method) == 1)
    tag += fmt::format(" data-look=\"{}\"", html_text(line.method));
  return tag;
}

bool is_bound(const Drawing& drawing, const PlotSeries& line) {
  return line.optimizer && drawing.bounds.contains(*line.optimizer);
}

std::string series_svg(const Drawing& drawing, const Frame& area, std::size_t place) {
  constexpr std::size_t kFewPoints = 16;  // are marked
  const PlotSeries& line = drawing.plot.series[place];
  const bool is_off = is_hidden(drawing, line);
  std::string svg = fmt::format("<g{}{}", line_attributes(drawing, place, is_off ? "off" : ""),
                                line.is_worse_at_end ? " data-worse" : "") +
                    (is_bound(drawing, line) ? " data-bound>" : ">");
  if (line.are_points) {
    std::string bars;
    for (std::size_t i = 0; i < line.low.size(); ++i)
      bars += fmt::format("M{:.0f} {:.0f}V{:.0f}", area.x(line.x[i]), area.y(line.low[i]),
                          area.y(line.high[i]));
    return svg + fmt::format(
                     "<path class=bars d=\"{}\"/><path class=\"line points\" d=\"{}\"><title>{}"
                     "</title></path></g>",
                     bars, path_of(area, line.x, line.y, Join::none), html_text(line.name));
  }
  if (!line.low.empty() && line.low != line.high) svg += band_of(area, line, drawing.join);
  std::string path = path_of(area, line.x, line.y, drawing.join);
  if (drawing.plot.kind == Plot::Kind::steps) path += fmt::format("H{:.0f}", kArea);
  svg += fmt::format("<path class={} d=\"{}\"",
                     drawing.join == Join::none ? "\"line points\"" : "line", path);
  // What the scripts show later they mark and name.
  svg += is_off ? "/>" : fmt::format("><title>{}</title></path>", html_text(line.name));
  svg += gaps_of(area, line, drawing.join);
  const bool are_few = drawing.join == Join::straight && line.x.size() <= kFewPoints;
  if (!is_off && (drawing.has_points || are_few))
    svg += fmt::format("<path class=points d=\"{}\"/>", path_of(area, line.x, line.y, Join::none));
  return svg + "</g>";
}

// A bar over the values that agree, with the published one on it; a band along a line otherwise.
std::string published_svg(const Frame& area, const PlotSeries& goal) {
  std::string svg = "<g class=goal>";
  if (goal.x.size() > 1) {
    svg += band_of(area, goal, Join::straight);
    svg += fmt::format("<path class=line d=\"{}\"/>",
                       goal.y.empty() ? fmt::format("M{:.0f} 0v{:.0f}", area.x(goal.x[1]), kArea)
                                      : path_of(area, goal.x, goal.y, Join::straight));
    return svg + "</g>";
  }
  const Real x = area.x(goal.x[0]);
  std::string ends;
  if (std::isfinite(goal.low[0]) && std::isfinite(goal.high[0])) {
    svg += fmt::format("<path class=span d=\"M{:.0f} {:.0f}V{:.0f}\"/>", x, area.y(goal.low[0]),
                       area.y(goal.high[0]));
    ends = fmt::format(" ({} to {})", figure(goal.low[0]), figure(goal.high[0]));
  }
  return svg + fmt::format(
                   "<path class=points d=\"M{:.0f} {:.0f}h0\"><title>published, {}: {}{}</title>"
                   "</path></g>",
                   x, area.y(goal.y[0]), html_text(goal.name), figure(goal.y[0]), ends);
}

// The markers of the lines that are shown: at most four a line, at its points before even steps
// across, which begin elsewhere for each line. Where the scripts have further lines, they mark all.
std::string marks_svg(const Drawing& drawing, const Frame& frame) {
  constexpr Real kMarks = 4, kGolden = 0.618;
  std::string svg;
  for (std::size_t place = 0; place < drawing.plot.series.size() && drawing.rest.empty(); ++place) {
    const PlotSeries& line = drawing.plot.series[place];
    if (line.method.empty() || line.are_points || is_hidden(drawing, line)) continue;
    const Real shift = kGolden * Real(line.optimizer.value_or(place));
    std::map<int, std::size_t> marked;
    for (std::size_t i = 0; i < line.x.size() && i < line.y.size(); ++i) {
      const Real x = frame.x(line.x[i]), y = frame.y(line.y[i]);
      if (!(x >= frame.left && x <= frame.right() && y >= frame.top && y <= frame.bottom()))
        continue;
      const Real step = kMarks * (x - frame.left) / frame.width - (shift - std::floor(shift));
      marked[static_cast<int>(std::floor(step))] = i;
    }
    std::string path;
    for (const auto& [step, i] : marked)
      path += fmt::format("M{:.1f} {:.1f}{}", frame.x(line.x[i]), frame.y(line.y[i]),
                          look_of(line.method).shape);
    svg += fmt::format("<path{} d=\"{}\"/>", line_attributes(drawing, place, "mark"), path);
  }
  return "<g class=marks>" + svg + "</g>";
}

std::size_t letters_of(std::string_view text) {
  constexpr unsigned kContinues = 0x80, kKind = 0xC0;  // bytes of UTF-8
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char byte) { return (static_cast<unsigned char>(byte) & kKind) != kContinues; }));
}

// Names at the ends of the lines that are shown, each below those above it that it would meet, and
// all above the lower edge.
std::string end_names(const Drawing& drawing, const Frame& frame) {
  constexpr Real kHeight = 14, kLetter = 6.6;
  constexpr std::size_t kLongest = 24;
  struct End {
    Real x, y, width;
    std::size_t place;
    std::string text;
  };
  std::vector<End> ends;
  for (std::size_t i = 0; i < drawing.plot.series.size(); ++i) {
    const PlotSeries& line = drawing.plot.series[i];
    std::size_t last = line.y.size();
    while (last > 0 && !std::isfinite(line.y[last - 1])) --last;
    if (last == 0 || is_hidden(drawing, line)) continue;
    std::string text = line.name;
    if (text.size() > kLongest) {
      std::size_t rest = text.size() - kLongest / 2 + 1;  // where a letter begins
      while (rest < text.size() && (text[rest] & 0xC0) == 0x80) ++rest;
      text = std::string(cut(text, kLongest / 2)) + "…" + text.substr(rest);
    }
    if (is_bound(drawing, line)) text = "≤ " + text;
    if (line.is_worse_at_end) text += " ✗";
    const Real x = drawing.plot.kind == Plot::Kind::steps ? frame.window.x_high : line.x[last - 1],
               width = kLetter * static_cast<Real>(letters_of(text));
    ends.push_back(
        {std::min(std::min(frame.x(x), frame.right()) + 6, frame.right() + kNameWidth - width),
         std::clamp(frame.y(line.y[last - 1]), frame.top, frame.bottom()), width, i, text});
  }
  const auto meet = [](const End& one, const End& other) {
    return one.x < other.x + other.width && other.x < one.x + one.width;
  };
  std::ranges::sort(ends, {}, &End::y);
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (meet(ends[i], ends[j])) ends[i].y = std::max(ends[i].y, ends[j].y + kHeight);
  std::string svg;
  for (std::size_t i = ends.size(); i-- > 0;) {
    End& end = ends[i];
    end.y = std::min(end.y, frame.bottom());
    for (std::size_t j = i + 1; j < ends.size(); ++j)
      if (meet(end, ends[j])) end.y = std::min(end.y, ends[j].y - kHeight);
    svg += fmt::format("<text x={:.0f} y={:.0f}{}>{}</text>", end.x, end.y + 4,
                       line_attributes(drawing, end.place, ""), html_text(end.text));
  }
  return "<g class=ends>" + svg + "</g>";
}

std::string axis_attribute(Real low, Real high, bool is_log, bool is_share) {
  return fmt::format("{:.6g} {:.6g} {}", low, high, is_log ? "log" : is_share ? "share" : "linear");
}

}  // namespace

std::string drawing_svg(const Drawing& drawing, Real tau) {
  const Plot& plot = drawing.plot;
  const Frame frame = frame_of(drawing), area = area_of(frame);
  const bool is_share = plot.kind == Plot::Kind::steps;
  std::string svg = fmt::format(
      "<svg class=\"chart{}\" viewBox=\"0 0 {:.0f} {:.0f}\" data-x=\"{}\" data-y=\"{}\"{}{} role=img "
      "aria-label=\"{}\"><title>{}</title><g class=axes>{}{}</g>",
      drawing.has_names ? drawing.has_points ? " wide marked" : " wide" : "",
      frame.right() + (drawing.has_names ? kNameWidth : 16), frame.bottom() + kBelow,
      axis_attribute(frame.window.x_low, frame.window.x_high, plot.is_log_x, false),
      axis_attribute(frame.window.y_low, frame.window.y_high, plot.is_log_y, is_share),
      drawing.attributes, drawing.rest.empty() ? "" : " data-rest=" + drawing.rest,
      html_text(plot.title + ". " + plot.reading + plot.caption), html_text(plot.title),
      x_axis(frame, plot.x_label), y_axis(frame, plot.y_label, is_share));
  svg += fmt::format(
      "<svg class=area x={:.0f} y={:.0f} width={:.0f} height={:.0f} viewBox=\"0 0 {:.0f} {:.0f}\" "
      "preserveAspectRatio=none>",
      frame.left, frame.top, frame.width, frame.height, kArea, kArea);
  for (const PlotSeries& line : drawing.ground)
    svg +=
        fmt::format("<path class=ground d=\"{}\"/>", path_of(area, line.x, line.y, Join::straight));
  if (drawing.tolerance)
    svg += fmt::format("<path class=tau data-scale={:.6g} d=\"M{:.0f} {:.0f}h{:.0f}\"/>",
                       *drawing.tolerance, -kBeyond * kArea, area.y(*drawing.tolerance * tau),
                       2 * kBeyond * kArea);
  for (std::size_t i = plot.series.size(); i-- > 0;)  // the first on top
    if (drawing.rest.empty() || !is_hidden(drawing, plot.series[i]))
      svg += series_svg(drawing, area, i);
  for (const PlotSeries& goal : plot.published) svg += published_svg(area, goal);
  for (const PlotSeries& end : drawing.ends)
    svg += fmt::format(
        "<g class=end><path d=\"{0}\"/><path class={1} d=\"{0}\"><title>{1}</title></path></g>",
        path_of(area, end.x, end.y, Join::none), html_text(end.name));
  return svg + "</svg>" + marks_svg(drawing, frame) +
         (drawing.has_names ? end_names(drawing, frame) : "") + "</svg>";
}

std::string hidden_lines_svg(const Drawing& drawing) {
  const Frame area = area_of(frame_of(drawing));
  std::string svg;
  for (std::size_t i = drawing.plot.series.size(); i-- > 0;)
    if (is_hidden(drawing, drawing.plot.series[i])) svg += series_svg(drawing, area, i);
  return svg;
}

std::string names_html(const Drawing& drawing) {
  std::string shown, others;
  std::size_t count = 0;  // of those that open on demand
  for (std::size_t i = 0; i < drawing.plot.series.size(); ++i) {
    const PlotSeries& line = drawing.plot.series[i];
    const bool is_off = is_hidden(drawing, line);
    count += is_off;
    (is_off ? others : shown) +=
        fmt::format("<button type=button aria-pressed={}{}>{}{}</button>", !is_off,
                    line_attributes(drawing, i, "name"), swatch(line.method), html_text(line.name));
  }
  if (!drawing.plot.published.empty())
    shown += fmt::format("<span class=goal>{} published, with its error</span>", swatch());
  if (count > 0)
    others = fmt::format("<details><summary>{} more</summary><div class=names>{}</div></details>",
                         count, others);
  return "<div class=names>" + shown + "</div>" + others;
}

std::string plot_html(const Plot& plot) {
  const Drawing drawing = drawing_of(plot);
  return fmt::format(
      "<figure class=plot id={}{}><figcaption><b>{}.</b> {}</figcaption>{}{}<p class=legend>{}</p>"
      "</figure>\n",
      plot.id, topic_attributes(plot.topic), html_text(plot.title), html_text(plot.reading),
      drawing_svg(drawing), names_html(drawing), html_text(plot.caption));
}

}  // namespace isoline::reports
