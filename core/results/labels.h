// The rows and columns of a study: which problems and optimizers it holds, and under which names.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/results/table.h"

namespace isoline::results {

// Of long labels the options alone that tell them from others of their method: those that all of
// the method share are left out, in "sip[inverse=newton,network-optimizer=adam[rate=1e-3]]" beside
// "sip[inverse=analytic,network-optimizer=adam[rate=1e-3]]" the network's optimizer. No two become
// the same.
std::vector<std::string> brief_labels(const std::vector<std::string>& labels);

// Names of optimizers. A file of rates gives one method other options on every problem; the method
// then keeps one row under its name, unless some problem has two of that name. A method with tuned
// rates stands beside itself, as "adam, tuned". A method that sees what others do not on some
// problems and no more than they on others is two: "sip, given P⁻¹" and "sip".
// What another program runs goes by the name that it gives itself, unless that is another's.
// Where a study holds a method at its defaults and at the rates of tables, it is "gd" and "gd,
// tuned"; on a problem where both are the same, its one run stands in both rows.
class OptimizerLabels {
 public:
  explicit OptimizerLabels(const Study& study);
  std::vector<std::string> of(const std::string& problem, const std::string& spec) const;
  const std::string& method(const std::string& spec) const { return names_.at(spec); }
  // Of all meanings.
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
