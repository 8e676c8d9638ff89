// A table of statistics as every format prints it, with the numbers that its text is made of.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/array.h"

namespace isoline {

// The text is the same in every format; the numbers, by what they are, go into report.json.
struct TableCell {
  using Numbers = std::vector<std::pair<std::string, Real>>;

  TableCell(const char* words) : text(words) {}
  TableCell(std::string words, Numbers values = {})
      : text(std::move(words)), numbers(std::move(values)) {}

  std::string text;
  Numbers numbers;
};

struct StatisticTable {
  std::string id;       // "data-profile"
  std::string title;    // "Data profile"
  std::string reading;  // a sentence on this very data
  std::string caption;  // what the figures are
  std::vector<std::string> columns;
  std::vector<std::vector<TableCell>> rows;  // the first cell is the name of the row
};

}  // namespace isoline
