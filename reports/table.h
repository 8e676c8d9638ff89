// A table of statistics as text, as every format prints it.
#pragma once

#include <string>
#include <vector>

namespace isoline {

struct StatisticTable {
  std::string id;       // "data-profile"
  std::string title;    // "Data profile"
  std::string reading;  // a sentence on this very data
  std::string caption;  // what the figures are
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

}  // namespace isoline
