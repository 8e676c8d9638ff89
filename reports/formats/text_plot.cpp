// Draws lines in letters: a, b, c, …; what was published is shaded, and crossed at its value.
#include "reports/formats/text_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "reports/formats/escape.h"
#include "reports/sections/plot_window.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr int kColumns = 68, kRows = 15, kBar = 2;  // a bar stands right of its point
constexpr const char *kBand = "░", *kValue = "━";

int place_of(Real value, Real low, Real high, bool is_log, int places) {
  if (std::isnan(value)) return 0;
  if (is_log) {
    value = std::log(std::max(value, low));
    low = std::log(low);
    high = std::log(high);
  }
  const Real share = std::clamp((value - low) / (high - low), 0.0, 1.0);
  return static_cast<int>(std::lround(share * (places - 1)));
}

// Rows from the top; a cell is one letter.
struct Canvas {
  const Plot& plot;
  Window window;
  std::vector<std::vector<std::string>> rows;

  explicit Canvas(const Plot& drawn)
      : plot(drawn),
        window(window_of(drawn)),
        rows(kRows, std::vector<std::string>(kColumns + kBar, " ")) {}

  int column(Real x) const {
    return place_of(x, window.x_low, window.x_high, plot.is_log_x, kColumns);
  }
  int row(Real y) const {
    return kRows - 1 - place_of(y, window.y_low, window.y_high, plot.is_log_y, kRows);
  }
  void put(int at_row, int at_column, const std::string& letter) {
    rows[std::size_t(at_row)][std::size_t(at_column)] = letter;
  }
};

// y at each column between two points, linear on the axes as drawn.
void draw_piece(Canvas& canvas, const PlotSeries& line, std::size_t i, const std::string& letter) {
  const int from = canvas.column(line.x[i]), to = canvas.column(line.x[i + 1]);
  const int start = canvas.row(line.y[i]), end = canvas.row(line.y[i + 1]);
  for (int column = from; column <= to; ++column) {
    const Real share = to > from ? Real(column - from) / Real(to - from) : 0;
    canvas.put(static_cast<int>(std::lround(start + share * (end - start))), column, letter);
  }
}

void draw_line(Canvas& canvas, const PlotSeries& line, const std::string& letter) {
  for (std::size_t i = 0; i + 1 < line.y.size(); ++i)
    if (!std::isnan(line.y[i]) && !std::isnan(line.y[i + 1])) draw_piece(canvas, line, i, letter);
}

void shade(Canvas& canvas, int column, Real low, Real high) {
  for (int row = canvas.row(high); row <= canvas.row(low); ++row) canvas.put(row, column, kBand);
}

void draw_band(Canvas& canvas, const PlotSeries& goal) {
  for (std::size_t i = 0; i < goal.x.size(); ++i)
    shade(canvas, canvas.column(goal.x[i]), goal.low[i], goal.high[i]);
  draw_line(canvas, goal, kValue);
}

void draw_bar(Canvas& canvas, const PlotSeries& goal) {
  for (int d = 1; d <= kBar; ++d) {
    const int column = canvas.column(goal.x[0]) + d;
    shade(canvas, column, goal.low[0], goal.high[0]);
    canvas.put(canvas.row(goal.y[0]), column, kValue);
  }
}

std::string legend(const Plot& plot) {
  std::string text;
  for (std::size_t i = 0; i < plot.series.size(); ++i)
    text += fmt::format("  {} {}\n", static_cast<char>('a' + i % 26),
                        terminal_text(plot.series[i].name));
  if (!plot.published.empty())
    text += fmt::format("  {} published, {} with its error\n", kValue, kBand);
  return text;
}

}  // namespace

std::string text_plot(const Plot& plot) {
  Canvas canvas(plot);
  const auto is_bar = [](const PlotSeries& goal) { return goal.x.size() == 1; };
  for (const PlotSeries& goal : plot.published)
    if (!is_bar(goal)) draw_band(canvas, goal);
  for (std::size_t i = plot.series.size(); i-- > 0;)  // the first on top
    draw_line(canvas, plot.series[i], std::string(1, static_cast<char>('a' + i % 26)));
  for (const PlotSeries& goal : plot.published)
    if (is_bar(goal)) draw_bar(canvas, goal);
  const Window& window = canvas.window;
  std::string text =
      fmt::format("{:>10}  {}\n", figure(window.y_high), terminal_text(plot.y_label));
  for (const auto& row : canvas.rows) {
    std::string line = fmt::format("{:>10} │{}", "", joined(row, ""));
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  text += fmt::format("{:>10} └", figure(window.y_low));
  for (int i = 0; i < kColumns; ++i) text += "─";
  const Real first =
      std::min(window.x_low, plot.series.at(0).x.at(0));  // iteration 0 of logarithms
  const std::string end = fmt::format("{} {}", figure(window.x_high), plot.x_label);
  text += fmt::format("\n{:>12}{:<{}}{}\n", "", figure(first),
                      std::max(1, kColumns - static_cast<int>(end.size())), end);
  return text + legend(plot);
}

}  // namespace isoline::reports
