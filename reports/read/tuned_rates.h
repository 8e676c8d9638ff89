// Where the rates of a study come from: the rows of the tables of rates that its runs used, each
// with what it was chosen from. OUT/rates.json, schema isoline.rates/1.
#pragma once

#include <string>
#include <vector>

#include "core/real.h"

namespace isoline::reports {

struct TunedRate {
  std::string problem, optimizer;  // the problem's spec, the optimizer's name
  std::string file;                // the table of rates that it stands in
  std::string paper;               // that published it; empty where a grid was tried
  std::string option;              // that was chosen: "rate"
  // Of a grid: its values, and the work of each to the tolerance it was judged by, the median over
  // the tuning seeds; infinite where it never got there.
  std::vector<Real> values, work;
  bool is_at_edge = false;  // the best value is the first or the last

  bool is_tuned() const { return !values.empty(); }
  bool is_ever_solved() const;
};

// None where the folder has no such file.
std::vector<TunedRate> read_rates(const std::string& folder);
std::vector<TunedRate> rates_from_text(const std::string& text, const std::string& origin);

}  // namespace isoline::reports
