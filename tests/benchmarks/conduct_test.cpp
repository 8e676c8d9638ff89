// The table of conduct: a method without a fault, and one fault for each column; the published
// table; the same x in the units of the user.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "benchmarks/audit/audit.h"
#include "benchmarks/plan/catalog.h"
#include "core/decompose.h"
#include "core/files.h"
#include "core/output.h"
#include "optimizers/optimizer.h"
#include "problems/problem.h"
#include "tests/benchmarks/builtin.h"

namespace isoline::benchmarks {

using optimizers::Linearization;
using optimizers::stepper_entry;
namespace {

int starts_of_process = 0;

// Gauss-Newton with halved steps, projected onto the bounds; or with the named fault.
struct Suspect {
  std::string fault = "none";
  struct State {
    Linearization at, trial;
    Vector r, step;
    std::int64_t steps = 0;
    Real share = 1;
  };
  State init(Meter& f, const Vector& theta) const {
    State s;
    if (fault == "remembers" && starts_of_process++ > 0) s.share = 0.9;
    if (fault == "prints") say(stdout, "a line\n");
    if (fault == "uncounted") f.problem().forward(Vector(2 * theta), unmetered);
    constexpr int kWasted = 50;
    for (int i = 0; fault == "bounds" && f.bounds() && i < kWasted; ++i)
      f.loss((1 + 1e-6 * i) * theta);
    return s;
  }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    const Matrix J = s.at.jacobian();
    s.at.residual(s.r);
    Matrix free = J;
    const Vector slope = J.transpose() * s.r;
    for (Index i = 0; f.bounds() && i < theta.size(); ++i)
      if (f.bounds()->is_active(theta, slope, i)) free.col(i).setZero();
    if (!least_squares(free, -s.r, 1e-12, s.step)) return Status::stalled;
    if (fault == "units")
      s.step = s.step.cwiseMin(1e-4 / s.at.loss()).cwiseMax(-1e-4 / s.at.loss());
    const bool is_small = (s.step.cwiseAbs().array() <= 1e-8 * theta.cwiseAbs().array()).all();
    if (is_small && fault != "endless")
      return fault == "worse" ? worsen(f, theta) : Status::converged;
    if (fault == "throws" && !std::isfinite(f.loss(theta + s.step)))
      throw std::runtime_error("there is no value");
    if (fault == "uncounted") f.problem().forward(Vector(theta + s.step), unmetered);
    for (Real share = s.share; share > 1e-12; share /= 2) {
      Vector ahead = theta + share * s.step;
      if (f.bounds() && fault != "outside") ahead = f.bounds()->nearest(ahead);
      if (f.loss(ahead) < s.at.loss()) {
        theta = ahead;
        return Status::running;
      }
    }
    return fault == "endless" ? Status::running : Status::converged;
  }
  static Status worsen(Meter& f, Vector& theta) {
    theta *= 1.01;
    f.loss(theta);
    return Status::converged;
  }

  mutable Point unmetered = {};
};
void fields(Suspect& o, auto& field) {
  field("fault", o.fault,
        Choices{"none", "uncounted", "worse", "endless", "throws", "outside", "units", "bounds",
                "remembers", "prints"},
        "what it does wrong");
}

using Marks = std::map<std::string, std::optional<bool>>;
Marks marks_of(const std::vector<ConductCell>& cells) {
  Marks marks;
  for (const ConductCell& cell : cells) marks[cell.column] = cell.holds;
  return marks;
}

Marks conduct_of_fault(const std::string& fault) {
  Catalog catalog = builtin_catalog();
  catalog.optimizers.add(stepper_entry<Suspect>(
      {.name = "suspect", .needs = {Oracle::forward, Oracle::jacobian}, .keeps_bounds = true}));
  std::vector<AuditedOptimizer> audits = {{.name = "suspect[fault=" + fault + "]"}};
  const HiddenFolder folder;
  measure_conduct(catalog, audits, folder.path());
  for (const ConductCell& cell : audits[0].conduct) {
    EXPECT_FALSE(cell.figures.empty()) << cell.column;
    for (const std::string& record : cell.records)
      EXPECT_TRUE(std::filesystem::exists(folder.path() / "runs" / record)) << cell.column;
  }
  return marks_of(audits[0].conduct);
}

TEST(Conduct, AMethodWithoutAFaultHasNoCross) {
  const Marks marks = conduct_of_fault("none");
  EXPECT_EQ(marks.size(), 11U);
  for (const auto& [column, holds] : marks)
    if (column != "scales") {
      EXPECT_TRUE(holds.value_or(column == "trial without a value")) << column;
    }
}

TEST(Conduct, EachFaultTurnsItsCellToACross) {
  const std::map<std::string, std::string> columns = {{"uncounted", "own counter"},
                                                      {"worse", "returned point"},
                                                      {"endless", "started at the solution"},
                                                      {"throws", "trial without a value"},
                                                      {"outside", "outside the bounds"},
                                                      {"units", "scales"},
                                                      {"bounds", "loose bound"},
                                                      {"remembers", "second run"},
                                                      {"prints", "text"}};
  for (const auto& [fault, column] : columns) {
    const Marks marks = conduct_of_fault(fault);
    ASSERT_TRUE(marks.contains(column)) << fault;
    EXPECT_EQ(marks.at(column), std::optional(false)) << fault << ": " << column;
  }
}

// The harness does not let a method exceed the budget or claim a false solution: here, records do.
TEST(Conduct, ARecordBeyondItsBudgetOrWithAFalseClaimHasACross) {
  std::vector<AuditedOptimizer> audits = {{.name = "levenberg-marquardt"}};
  const HiddenFolder folder;
  measure_conduct(catalog(), audits, folder.path());
  std::map<std::string, Record> records;
  for (const std::filesystem::path& file :
       std::filesystem::directory_iterator(folder.path() / "runs"))
    if (file.extension() == ".json") {
      const Record record = read_record(file);
      for (const ConductRun& run : conduct_runs())
        if (record.request.problem.asked == "conduct[input=" + run.input + "]" &&
            record.request.budget.work == run.work && record.request.threads == run.threads)
          records[run.name] = record;
    }
  ASSERT_EQ(records.size(), conduct_runs().size());
  EXPECT_EQ(marks_of(conduct_of(catalog(), records)), marks_of(audits[0].conduct));
  records.at("RB in 10").summary.work = 11;
  Record& line = records.at("line");
  line.status = Status::converged;
  line.answer->x[0][0] += 1e-3;
  const Marks marks = marks_of(conduct_of(catalog(), records));
  EXPECT_EQ(marks.at("beyond a budget"), std::optional(false));
  EXPECT_EQ(marks.at("claims success"), std::optional(false));
}

// What holds in any build; counts of calls may differ in another one. A difference: measure the
// table again, as docs/conduct.md shows.
TEST(Conduct, ThePublishedTableIsThatOfEveryBuiltInMethod) {
  std::vector<AuditedOptimizer> audits;
  for (const std::string& name : catalog().optimizers.ready().names())
    audits.push_back({.name = name});
  const HiddenFolder folder;
  measure_conduct(catalog(), audits, folder.path());
  const auto published = audit_from_text(std::string(embedded_conduct()), "conduct.json");
  std::erase_if(audits, [](const AuditedOptimizer& one) { return one.conduct.empty(); });
  ASSERT_EQ(published.size(), audits.size());
  for (std::size_t i = 0; i < audits.size(); ++i) {
    EXPECT_EQ(published[i].name, audits[i].name);
    for (const ConductCell& cell : audits[i].conduct)
      if (cell.column == "started at the solution") {  // at a loss of 0
        EXPECT_FALSE(cell.figures.starts_with("diverged")) << audits[i].name;
      }
    const Marks now = marks_of(audits[i].conduct), then = marks_of(published[i].conduct);
    for (const char* column : {"beyond a budget", "trial without a value", "claims success",
                               "outside the bounds", "text"}) {
      EXPECT_EQ(now.at(column), then.at(column)) << audits[i].name << ": " << column;
      if (now.at(column) == std::optional(false)) {
        EXPECT_EQ(audits[i].name, "sip-newton") << column;
      }
    }
  }
}

}  // namespace
}  // namespace isoline::benchmarks
