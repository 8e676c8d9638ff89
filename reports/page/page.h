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
#include "reports/sections/drawings.h"
#include "reports/sections/figures.h"
#include "reports/sections/sections.h"

namespace isoline::reports {

// A section as every other: sentences, plots, tables. Complete without scripts.
std::string section_html(const Section& section);
std::string prose_html(std::string_view text);  // html_text with code between backticks

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
// A row per pair of a problem and an optimizer.
Table cells_table(const Comparison& comparison,
                  const std::vector<std::pair<std::size_t, std::size_t>>& cells);
std::string claims_html(const Document& document);  // verdicts, and each claim with its evidence

// Drawings with their words.
std::string curves_html(const Comparison& comparison, std::size_t problem);  // the report's own
// {"charts": the other curves, "rest": {hidden lines of each drawing}}, which scripts show on
// demand.
std::string curves_json(const Comparison& comparison, std::size_t problem);
std::string figure_lines_json(const Document& document);  // [hidden lines of each figure]
std::string planes_html(const Comparison& comparison, std::size_t problem);
std::string figures_html(const Document& document);
// Fields. Bytes 1 to 255, of which 128 is 0 and 255 twice `scale`: colours end at ±scale, and what
// a difference of two may need is not lost before. Beyond twice the scale a value is cut.
std::string field_bytes(const std::vector<float>& values, Real scale);
// The page before what waits is compressed.
std::string readable_html(const Document& document);
std::string radix64(std::string_view bytes);  // RFC 4648, section 4
std::string letters_of(std::string_view bytes);
// A byte a cell, painted by the scripts in the colours of a ramp, "grey" or "diverging"; without
// bytes, from the data of the page.
std::string canvas_html(std::string_view bytes, Index rows, Index columns, std::string_view ramp,
                        std::string_view words);
std::string fields_html(const Comparison& comparison, const FoundFields& all);
std::string fields_json(const FoundFields& all);

// The data of the scripts, as JSON. The page has them compressed: they are three quarters of it.
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
// † tells what an optimizer sees that others do not, § that its figures are claims of others; empty
// where neither holds.
std::string marks_html(const OptimizerAxis& axis);

// One colour a kind of method, in every report; within a kind a shade of it by rank. Dash and
// marker are the method's.

std::string kind_title(std::string_view kind);  // "Adaptive gradients"
// Rules of the style sheet: what has data-s has the colour, dash and marker of that optimizer.
std::string kind_rules(const Comparison& comparison);
// A short line in the colour and dash of the element around it, with the marker of a method.
std::string swatch(const std::string& method = "");

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

std::string x_axis(const Frame& frame, const std::string& label);  // with a line per tick
std::string y_axis(const Frame& frame, const std::string& label, bool is_share);

Frame framed(const Drawing& drawing, Frame place);  // the same place with the drawing's window
std::string drawing_svg(const Drawing& drawing,
                        Real tau = 1);  // hidden lines that the data have are left out
std::string hidden_lines_svg(const Drawing& drawing);  // which scripts show on demand
// Its lines as buttons that show and hide them, and what the marks of published values mean.
std::string names_html(const Drawing& drawing);

std::string plot_html(const Plot& plot);

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
