// A table of statistics as every format prints it, with the numbers that its text is made of.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/array.h"

namespace isoline::reports {

// The text is the same in every format; the numbers, by what they are, go into report.json.
struct TableCell {
  using Numbers = std::vector<std::pair<std::string, Real>>;

  TableCell(const char* words) : text(words) {}
  TableCell(std::string words, Numbers values = {})
      : text(std::move(words)), numbers(std::move(values)) {}

  std::string text;
  Numbers numbers;
  std::string note = {};  // what the page tells who points at it
};

// What a row or a column is about, by index in the comparison: filters go by it.
struct TableSubject {
  std::optional<std::size_t> optimizer, problem;
};

struct StatisticTable {
  std::string id;       // "data-profile"
  std::string title;    // "Data profile"
  std::string reading;  // a sentence on this very data
  std::string caption;  // what the figures are
  std::vector<std::string> columns;
  std::vector<std::vector<TableCell>> rows;  // the first cell is the name of the row
  std::vector<TableSubject> row_subjects = {}, column_subjects = {};  // may be fewer, or none
};

}  // namespace isoline::reports
