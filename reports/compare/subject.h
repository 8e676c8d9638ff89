// A cell of a result folder or of a baseline, in the one form in which two results are compared,
// and the values that many cells share.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/options.h"
#include "core/records/record.h"
#include "core/status.h"
#include "core/threads.h"
#include "reports/read/reached.h"

namespace isoline::reports {

// What tells two values apart.
inline std::string key_of(const std::string& text) { return text; }
std::string key_of(const OptionValues& options);
std::string key_of(const std::map<std::string, std::string>& texts);

// Read as the value itself. It lives as long as the program.
template <class Value>
class Shared {
 public:
  Shared() : Shared(Value()) {}
  template <std::convertible_to<Value> Given>
  requires(!std::same_as<std::remove_cvref_t<Given>, Shared>) Shared(Given&& given)
      : value_(pooled(Value(std::forward<Given>(given)))) {}

  operator const Value&() const { return *value_; }
  const Value& operator*() const { return *value_; }
  const Value* operator->() const { return value_; }
  friend bool operator==(const Shared& a, const Shared& b) { return a.value_ == b.value_; }

 private:
  static const Value* pooled(Value&& value) {
    static std::mutex mutex;
    static std::unordered_map<std::string, Value> pool;
    std::string key = key_of(value);
    const std::lock_guard lock(mutex);
    return &pool.try_emplace(std::move(key), std::move(value)).first->second;
  }

  const Value* value_;
};

// A cell of a result folder or of a baseline, in the one form in which two results are compared.

// Less is better.
struct Quantity {
  Shared<std::string> group;  // "work" of "work to 1e-3"
  Shared<std::string> name;
  Real value = kNever;
  Real scale = 0;  // of the problem: where rounding and what is too small to tell are measured from
};

// What runs did that started one unit in the last place away.
struct Perturbed {
  Real moved = 0;                   // the least tolerance within which all agree with the subject
  std::vector<std::string> states;  // how each ended
  std::array<std::size_t, kTolerances.size()> reached{};  // of them, how many reached each target
};

// A problem or an optimizer as a run was given it; what is not known is empty.
struct Given {
  std::string name;
  std::string asked;             // as typed: defaults and rates unfilled
  std::string spec;              // the name and what differs from the defaults
  Shared<OptionValues> options;  // all of them
};

struct Subject {
  std::string key;    // what joins two results
  std::string title;  // "heat × gd, seed 3"
  Given problem, optimizer;
  std::string terms;             // seed, budget and threads asked for; empty: unknown
  std::string state;             // "target"; "target 3, crashed 1"
  int badness = 0;               // of the state: the greater the worse
  std::size_t lost = 0;          // runs that went wrong or no longer apply
  std::set<std::string> builds;  // of its records
  Shared<BuildParts> parts;      // digests of its build's parts; empty: unknown
  std::string asked;             // digest of what a pair was asked in all its seeds
  Aim aim = Aim::loss;
  std::vector<Quantity> quantities;
  std::string trace;  // digest of its path; empty: unknown
  // Digests of what else is deterministic, by name and in its order.
  std::vector<std::pair<Shared<std::string>, std::uint64_t>> members;
  std::string rest;                 // digest of those
  std::vector<Real> seconds;        // repetitions
  std::size_t senseless_times = 0;  // of them, left out: infinite, or not a number
  std::string processor;
  bool is_cut = false;                 // a clock or a kill ended it
  std::string doubt;                   // why its record cannot be trusted; empty: it can
  std::optional<Perturbed> perturbed;  // where a baseline has measured it
};

// What runs of every kind have in common; less is better.
Subject subject_that_ended(Status status);
int badness_of(Status status);
Status status_named(const std::string& name);  // UsageError where there is none
std::string title_of(const Given& problem, const Given& optimizer, std::uint64_t seed);
Quantity loss_quantity(const std::string& name, Real loss, Real scale);
Quantity x_error_quantity(Real x_error, Real scale);
Quantity work_quantity(Real tau, Real work);
Quantity found_quantity(Real tau, Real work);  // until x was found
// What a run took to one of the targets, in the sense of an aim; infinite where it missed it.
Real work_to(const Subject& subject, Aim aim, Real tau);

// All of a record but its figures; and those. `reference` sets f_L where a problem declares none,
// so that both sides have the same targets.
Subject subject_without_figures(const Record& record);
void add_figures(Subject& subject, const Record& record, const BestKnown& reference);

std::vector<Subject> subjects_of(const Study& study, const BestKnown& reference);

// Reads a result folder as subjects of a comparison, record by record: a hundred thousand of them
// take a tenth of the memory of their curves.

struct FolderSubjects {
  std::vector<Subject> subjects;  // by problem, optimizer, seed
  BestKnown best;                 // of the folder's own runs
  std::size_t unreadable = 0, superseded = 0;
};

// `reference` sets f_L where a problem declares none; else the folder's own runs do. A missing
// folder is a UsageError.
FolderSubjects read_subjects(const std::string& folder, const std::optional<BestKnown>& reference,
                             const Listener& listener = {});

}  // namespace isoline::reports
