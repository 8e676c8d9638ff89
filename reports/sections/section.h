// The nouns of a report, which every format lays out: sections of sentences, tables and plots.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/real.h"

namespace isoline::reports {

// The subject of a row, a column or a table: filters of the page use it.
struct Topic {
  std::optional<std::size_t> optimizer = {}, problem = {};  // indices in the comparison
  std::string method = {};  // an optimizer by name, for all settings
  std::string claim = {};   // by its ID
};

// The text is the same in every format; the numbers, by what they are, go into report.json.
struct TableCell {
  using Numbers = std::vector<std::pair<std::string, Real>>;

  TableCell(const char* words) : text(words) {}
  TableCell(std::string words, Numbers values = {})
      : text(std::move(words)), numbers(std::move(values)) {}

  std::string text;
  Numbers numbers;
  std::string note = {};    // the tooltip on the page
  std::string remark = {};  // beside the text, in small
  std::string link = {};    // where the page leads from here
  // The problem and the optimizer of its runs, where neither row nor column names them.
  std::optional<std::pair<std::size_t, std::size_t>> of = {};
  bool is_best = false;           // of its column
  std::optional<int> shade = {};  // of a heat map: 0 the best, then by factors of two, to 7
};

struct Table {
  std::string id = {};       // "data-profile"
  std::string title = {};    // "Data profile"; may be empty where it is the section's only one
  std::string reading = {};  // a sentence on this very data
  std::string caption = {};  // what the figures are
  std::vector<std::string> columns = {};
  std::vector<std::vector<TableCell>> rows = {};           // a short row's last cell spans the rest
  std::vector<Topic> row_topics = {}, column_topics = {};  // may be fewer, or none
  Topic topic = {};
  std::vector<std::string> meanings = {};  // of the columns, for a new reader
  // a letter a column: r figures, l words, p sentences, c commands
  std::string align = {};
  bool is_folded = false;  // behind its reading, where a format can fold
  std::size_t names = 1;   // columns that name the row, repeated in each part of a wide table
  std::vector<std::size_t> parts = {};  // how many others stand together where room is narrow
  std::size_t most_columns = 0;         // of others side by side in any format; 0: all

  char align_of(std::size_t column) const {
    return column < align.size() ? align[column] : column == 0 ? 'l' : 'r';
  }
  bool is_wordy() const { return align.find_first_of("pc") != std::string::npos; }
};

// The part of one optimizer, or of one quantity. Steps: y(x) from each x on, with a band. Lines:
// y(x) from point to point, with a band.
struct PlotSeries {
  std::optional<std::size_t> optimizer = {};
  std::string name = {};
  // low and high may be empty; not-a-number: nothing there
  std::vector<Real> x = {}, y = {}, low = {}, high = {};
  bool is_worse_at_end = false;  // the answer that it returned is worse than the line's best
  bool are_points = false;       // no line; low and high are then bars
  std::string method = {};       // whose dash and marker it has
};

struct Plot {
  enum class Kind { steps, lines };
  Kind kind = Kind::steps;
  std::string id, title;
  std::string reading;  // a sentence on this very data
  std::string caption;  // what is drawn, of how many, and how many of them failed
  std::string x_label, y_label;
  bool is_log_x = false, is_log_y = false;
  std::vector<PlotSeries> series = {};
  std::vector<PlotSeries> published = {};  // drawn into lines; of one point: where it is read
  Topic topic = {};
};

struct Reading {
  std::string title;  // what it is on; may be empty
  std::string text;
};

struct Section {
  std::string id, title;
  std::string lead = {};               // what its figures are
  std::vector<Reading> readings = {};  // what this data shows, a sentence each
  std::vector<Table> tables = {};
  std::vector<Plot> plots = {};
  std::string command = {};    // the command that repeats it
  std::string otherwise = {};  // what the page says where there is nothing

  bool is_empty() const { return readings.empty() && tables.empty() && plots.empty(); }
};

}  // namespace isoline::reports
