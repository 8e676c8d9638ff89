// The HTML page and its parts. An element with data-s or data-p, the index of an optimizer or
// problem, is hidden where the reader filters that one out; with both, where either is.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/results/ranking.h"
#include "reports/sections/claims.h"
#include "reports/sections/figures.h"
#include "reports/sections/sections.h"

namespace isoline::reports {

// A section as every other: sentences, plots, tables. Complete without scripts.
std::string section_html(const Section& section);

// What no other format has.
std::string details_html(const Comparison& comparison);
// One article each, with what fields its runs keep.
std::string problems_html(const Comparison& comparison, const AllFields& fields);
std::string methods_html(const Comparison& comparison);     // the grid of properties
std::string optimizers_html(const Comparison& comparison);  // one article each
// What its runs asked for, as counted, not the least that it can do with: "forward, jacobian,
// inverse (on 3 of 20)" settings.
std::string counted_oracles(const Comparison& comparison, std::size_t optimizer);
// Parts of the articles: formula, source and note of component metadata; a method's results in
// these runs, its options, and which measured properties it has.
std::string sheet_html(const Sheet* sheet, const std::string& facts = "");
std::string problem_sheet_html(const ProblemAxis& problem);
std::string method_facts_html(const Comparison& comparison, std::size_t optimizer);
std::string options_html(const Comparison& comparison, std::size_t optimizer, const Sheet& sheet);
std::string properties_html(const Comparison& comparison, std::size_t optimizer);
// A row per pair of a problem and an optimizer; the last column has the command that repeats it.
Table cells_table(const Comparison& comparison,
                  const std::vector<std::pair<std::size_t, std::size_t>>& cells);
std::string claims_html(const Document& document);  // verdicts, and each claim with its evidence

// Drawings with their words.
std::string curves_html(const Comparison& comparison, std::size_t problem);
std::string planes_html(const Comparison& comparison, std::size_t problem);
std::string figures_html(const Document& document);
// The best two of a ranking and the best of each kind, at most eight: more cannot be told apart.
inline constexpr std::size_t kMostShown = 8;
std::set<std::size_t> shown_at_first(const Comparison& comparison,
                                     const std::vector<std::size_t>& ranking);

// Isolines by marching squares (Lorensen, Cline 1987, in two dimensions): segments apart by NaN,
// linear between grid points. A cell with a corner that is not finite is left out.
PlotSeries isoline(const Landscape& landscape, Real level);
// Spaced as the landscape asks: 2^i for i = −5 … 7, or even steps of L^0.2 or of log L.
std::vector<Real> contour_levels(const Landscape& landscape);

// Fields. Bytes 1 to 255, of which 128 is 0 and 255 twice `scale`: colours end at ±scale, and what
// a difference of two may need is not lost before. Beyond twice the scale a value is cut.
std::string field_bytes(const std::vector<float>& values, Real scale);
std::string radix64(std::string_view bytes);  // RFC 4648, section 4
// A byte a cell, painted by the scripts in the colours of a ramp, "grey" or "diverging".
std::string canvas_html(std::string_view bytes, Index rows, Index columns, std::string_view ramp,
                        std::string_view words);
std::string fields_html(const Comparison& comparison, const FoundFields& all);
std::string fields_json(const FoundFields& all);

// The data of the scripts, as JSON that is safe inside a script element.
std::string page_data(const Document& document, const AllFields& fields);
std::string runs_address(const Document& document);  // of the folder of records, from the page
std::string json_quoted(const std::string& text);
template <class Range, class Item>
std::string json_list(Range&& range, Item item) {  // of whatever `item` writes
  std::string text = "[";
  for (const auto& one : range) {
    if (text.size() > 1) text += ',';
    text += item(one);
  }
  return text + "]";
}
// Those that the page can be switched to, in the order of its data.
std::vector<Measure> measures_of(const Comparison& comparison);
// Those of the 51 targets that the page holds medians to: all, but of a study too large for that
// the tolerances of its report alone.
std::vector<std::size_t> targets_of(const Comparison& comparison);
// Whether its page leaves out what would make it too long: commands of cells, which stand in
// report.csv, and curves by other measures than its own.
bool is_large(const Comparison& comparison);

// † tells what an optimizer sees that others do not, § that its figures are claims of others; empty
// where neither holds.
std::string marks_html(const OptimizerAxis& axis);

// One colour a kind of method, in every report; within a kind a dash and a shade of it by rank.

std::string kind_title(std::string_view kind);  // "Adaptive gradients"
// Rules of the style sheet: what has data-s has the colour and dash of that optimizer. No two of a
// kind have both alike, up to 25, and no two of five either.
std::string kind_rules(const Comparison& comparison);
std::string swatch();  // a short line in the colour and dash of the element around it

// What an element is about, as attributes by which the page filters.
std::string topic_attributes(const Topic& topic);

// All drawings as SVG that needs no browser: axes, and an area of lines in coordinates from 0 to
// 5,000, so that a script zooms by a change of the view and reads every point.

struct Frame {
  Real left = 0, top = 0, width = 0, height = 0;  // on the paper
  Window window = {};
  bool is_log_x = false, is_log_y = false;

  Real x(Real value) const;  // on the paper; what has no logarithm is put at the low edge
  Real y(Real value) const;
  Real right() const { return left + width; }
  Real bottom() const { return top + height; }
};

// Round values within, at most some ten of them: powers of two or ten where logarithmic.
std::vector<Real> ticks_of(Real low, Real high, bool is_logarithmic);

std::string tick_text(Real value);

std::string x_axis(const Frame& frame, const std::string& label);  // with a grid line a tick
std::string y_axis(const Frame& frame, const std::string& label, bool is_share);

enum class Join { straight, steps, none };

// A plot of lines, with what only the page draws.
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
  std::string attributes;          // of the element
};
Drawing drawing_of(const Plot& plot);
Frame framed(const Drawing& drawing, Frame place);  // the same place with the drawing's window
std::string drawing_svg(const Drawing& drawing, Real tau = 1);
// The lines that are not hidden at first; all where every one is.
Plot shown_lines(const Drawing& drawing);
// Its lines as buttons that show and hide them, and what the marks of published values mean.
std::string names_html(const Drawing& drawing);

std::string plot_html(const Plot& plot);

// Every drawing of a document under a name of letters, digits and hyphens that no other one has:
// the plots of sections, the curves of each problem by the report's own measure, the figures of
// papers, the plots of claims.
struct NamedDrawing {
  std::string name;
  Drawing drawing;
  std::optional<std::size_t> problem = {};  // whose curves these are
};
std::vector<NamedDrawing> drawings_of(const Document& document);
std::optional<Drawing> own_curves(const Comparison& comparison, std::size_t problem);
std::string file_name_of(std::string_view title);  // "heat[n=32]" is "heat-n-32"

// The lines of a drawing that are shown at first, for a column of a paper, 3.2 inches wide: text of
// 7 points and more, names below. SVG has its colours in each element; PGF is for \\input.
std::string paper_svg(const Drawing& drawing);
std::string paper_pgf(const Drawing& drawing);
std::string points_csv(const Drawing& drawing);  // line,x,y,low,high of all lines, as computed

// A site of several results: its pages by path, without the reports, which are beside them in
// reports/NAME/ with their figures in reports/NAME/figures/.
struct SiteResults {
  std::string name;
  const Document* document = nullptr;
  std::vector<NamedDrawing> drawings = {};  // of the document
};
struct Site {
  std::vector<SiteResults> results;
  std::vector<Judgement> claims;            // of all papers
  Section items;                            // of items_section()
  std::map<std::string, std::string> docs;  // HTML of the pages of docs/, by name without ending
};
std::map<std::string, std::string> site_pages(const Site& site);

}  // namespace isoline::reports
