// The drawings of a report as data: lines with their points, axes, units and window. The page draws
// them as SVG; report.json has their numbers, from which scripts draw the figures of papers.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "reports/sections/sections.h"

namespace isoline::reports {

enum class Join { straight, steps, none };
inline constexpr std::string_view kJoinNames[] = {"straight", "steps", "none"};

// The dash and the marker of a method: of its name alone, so that it has them in every report, site
// and exported figure. `marker` is the letter of matplotlib; `shape` the same as a relative path of
// SVG, from its centre.
struct Look {
  std::string_view dash;
  char marker;
  std::string_view shape;
};
Look look_of(std::string_view method);
// A line of an optimizer, without points: its name, and whose dash and marker it has.
PlotSeries line_of(const Comparison& comparison, std::size_t optimizer);

// A plot of lines, with how it is drawn.
struct Drawing {
  Plot plot;
  Join join = Join::straight;
  bool has_names = false;                           // at the ends of the lines
  bool has_points = false;                          // marked, be they many
  bool is_to_scale = false;                         // a unit across is a unit up
  std::optional<std::set<std::size_t>> shown = {};  // optimizers whose lines are, at first; or all
  std::optional<Window> window;                     // else what the lines that are shown need
  std::optional<Real> tolerance;   // a line at τ times this, at the τ of the report
  std::vector<PlotSeries> ground;  // thin lines below all others
  std::vector<PlotSeries> ends;    // a point each: the start, and the goal
  std::set<std::size_t> bounds;    // optimizers whose counts to a target are at most those drawn
  std::string attributes;          // of the element on the page
  std::string rest;                // the name of its hidden lines in the data of the page
};
Drawing drawing_of(const Plot& plot);
Window window_of(const Drawing& drawing);
bool is_hidden(const Drawing& drawing, const PlotSeries& line);  // at first
// The lines that are not hidden at first; all where every one is.
Plot shown_lines(const Drawing& drawing);

// Every drawing of a document under a name of letters, digits and hyphens that no other one has:
// the plots of sections, the curves of each problem by the report's own measure, the figures of
// papers, the plots of claims.
struct NamedDrawing {
  std::string name;
  Drawing drawing;
  std::optional<std::size_t> problem = {};  // whose curves these are
};
std::vector<NamedDrawing> drawings_of(const Document& document);
std::string file_name_of(std::string_view title);  // "heat[n=32]" is "heat-n-32"

// The curves of a problem by each measure and quantity, of which one is the report's own.
struct CurveDrawing {
  Drawing drawing;
  Measure by = Measure::work;
  std::string_view vertical;
  bool is_own = false;
};
std::vector<CurveDrawing> curve_drawings(const Comparison& comparison, std::size_t problem);
std::optional<Drawing> own_curves(const Comparison& comparison, std::size_t problem);
Drawing figure_drawing(const Comparison& comparison, const Figure& figure);

// Paths of a problem of two unknowns over isolines of its loss, in x and in y, as far as the
// problem has them and runs kept their paths.
struct Plane {
  Drawing drawing;
  std::string title, reading;
};
std::vector<Plane> planes_of(const Comparison& comparison, std::size_t problem);
bool has_planes(const Comparison& comparison, std::size_t problem);
// Isolines by marching squares (Lorensen, Cline 1987, in two dimensions): lines apart by NaN,
// linear between grid points. A cell with a corner that is not finite is left out.
PlotSeries isoline(const Landscape& landscape, Real level);
// Spaced as the landscape asks: 2^i for i = −5 … 7, or even steps of L^0.2 or of log L.
std::vector<Real> contour_levels(const Landscape& landscape);

// The best two of a ranking and the best of each kind, at most eight: more cannot be told apart.
inline constexpr std::size_t kMostShown = 8;
std::set<std::size_t> shown_at_first(const Comparison& comparison,
                                     const std::vector<std::size_t>& ranking);
// Those that the page can be switched to, in the order of its data.
std::vector<Measure> measures_of(const Comparison& comparison);
// Those of the 51 targets that the page holds medians to: all, but of a study too large for that
// the tolerances of its report alone.
std::vector<std::size_t> targets_of(const Comparison& comparison);
// Whether its page leaves out what would make it too long: commands of cells, which stand in
// report.csv, and curves by other measures than its own.
bool is_large(const Comparison& comparison);

}  // namespace isoline::reports
