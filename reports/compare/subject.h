// What two results can have in common, in the one form in which they are compared: a cell of two
// record folders, or a pair of problem and optimizer in two reports.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/records/record.h"
#include "reports/read/reached.h"

namespace isoline::reports {

// Less is better.
struct Quantity {
  std::string group;  // "work" of "work to 1e-3"
  std::string name;
  Real value = kNever;
  Real scale = 0;  // where rounding is measured from: the value at the start
};

// What runs did that started one unit in the last place away.
struct Perturbed {
  Real moved = 0;                   // the least tolerance within which all agree with the subject
  std::vector<std::string> states;  // how each ended
  std::array<std::size_t, kTolerances.size()> reached{};  // of them, how many reached each target
};

struct Subject {
  std::string key;               // what joins two results
  std::string title;             // "heat × gd, seed 3"
  std::string state;             // "target"; "target 3, crashed 1"
  int badness = 0;               // of the state: the greater the worse
  std::size_t lost = 0;          // runs that went wrong or no longer apply
  std::set<std::string> builds;  // of its records
  std::string asked;             // digest of what was asked, where the key does not tell
  std::vector<Quantity> quantities;
  std::string trace;          // digest of all that is deterministic in it; empty: unknown
  std::vector<Real> seconds;  // repetitions
  std::string processor;
  bool is_nondeterministic = false;    // a clock or a kill ended it
  std::optional<Perturbed> perturbed;  // where a baseline has measured it
};

// What runs of every kind have in common; less is better.
Subject subject_that_ended(Status status);
int badness_of(Status status);
Status status_named(const std::string& name);  // UsageError where there is none
Quantity loss_quantity(const std::string& name, Real loss, Real start);
Quantity x_error_quantity(Real x_error, Real start);
Quantity work_quantity(Real tau, Real work);

// `reference` sets f_L where a problem declares none, so that both sides have the same targets.
std::vector<Subject> subjects_of(const Study& study, const BestKnown& reference);
std::vector<Subject> subjects_of_report(const Json& report);  // schema isoline.report/1

}  // namespace isoline::reports
