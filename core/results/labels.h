// The rows and columns of a study: which problems and optimizers it holds, and under which names.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/results/table.h"

namespace isoline::results {

// Long labels keep only the options that distinguish them within their method. Options with equal
// values in all are omitted: in "sip[inverse=newton,network-optimizer=adam[rate=1e-3]]" beside
// "sip[inverse=analytic,network-optimizer=adam[rate=1e-3]]", the network's optimizer. No two labels
// become equal.
std::vector<std::string> brief_labels(const std::vector<std::string>& labels);

// Names of optimizers. A file of rates gives one method different options on each problem. The
// method then keeps one row under its name, unless some problem has two runs of that name. A method
// with tuned rates gets a row of its own, "adam, tuned". A method with extra information on some
// problems only becomes two: "sip, given P⁻¹" and "sip". An external program has the name that it
// gives itself, unless another method has this name. If a study contains a method with its defaults
// and with rates of tables, they are "gd" and "gd, tuned"; if both are equal on a problem, its
// single run is in both rows.
class OptimizerLabels {
 public:
  explicit OptimizerLabels(const Study& study);
  std::vector<std::string> of(const std::string& problem, const std::string& spec) const;
  const std::string& method(const std::string& spec) const { return names_.at(spec); }
  // For all meanings.
  std::vector<std::string> wholes(const std::string& problem, const std::string& spec) const;
  std::string meaning(const std::string& problem, const std::string& whole) const;
  bool has_meanings(const std::string& whole) const { return meanings_.contains(whole); }
  bool is_foreign(const std::string& spec) const { return foreign_.contains(spec); }

 private:
  using Pair = std::pair<std::string, std::string>;

  void find_foreign(const Study& study);
  void find_both_ways(const Study& study);
  void find_meanings(const Study& study);

  std::set<Pair> tuned_;                        // problem and optimizer, as specs
  std::set<std::string> by_name_;               // names that stand for all their specs
  std::map<std::string, std::string> names_;    // by spec, as records have them
  std::map<std::string, std::string> foreign_;  // by spec: what other programs call themselves
  std::set<std::string> both_ways_;             // names at their defaults and with rates
  std::set<Pair> rated_;                        // problem and name, with another rate
  // By label of all meanings and problem: what is given there beyond the problem, or nothing.
  std::map<std::string, std::map<std::string, std::string>> meanings_;
};

std::vector<ProblemAxis> problem_axis(const Study& study);
std::vector<OptimizerAxis> optimizer_axis(const Study& study, const OptimizerLabels& labels);

}  // namespace isoline::results
