// Faults planted into copies of sound results: comparisons catch each, and reports refuse records
// that contradict themselves. What changes no result stays equal.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/json.h"
#include "tests/reports/gate_fixture.h"

namespace isoline::reports {
namespace {

using Records = std::vector<Record>;
using Texts = std::vector<std::string>;  // of files

constexpr auto kForward = static_cast<std::size_t>(Oracle::forward);
constexpr auto kJacobian = static_cast<std::size_t>(Oracle::jacobian);

// A Jacobian a step, at a price of 4, beside a forward.
void renew_work(Record& record) {
  const auto work_of = [&](std::int64_t calls) {
    return calls * (record.prices[kForward] + record.prices[kJacobian]);
  };
  record.curve.work.clear();
  for (const std::int64_t i : record.curve.iteration) record.curve.work.push_back(work_of(i));
  for (const char* oracle : {"forward", "jacobian"}) {
    record.curve.counts[oracle] = record.curve.iteration;
    record.hits->counts[oracle] = record.hits->iteration;
  }
  record.hits->forwards = record.hits->iteration;
  for (std::size_t j = 0; j < record.hits->work.size(); ++j)
    record.hits->work[j] = record.hits->iteration[j] < 0 ? -1 : work_of(record.hits->iteration[j]);
  record.counts[kForward] = record.counts[kJacobian] = record.summary.iterations;
  record.summary.work = work_of(record.summary.iterations);
}

// Where the curve first meets each target, f_L and s as they are now.
void renew_hits(Record& record) {
  for (std::size_t j = 0; j < record.hits->target.size(); ++j) {
    const Real goal = *record.minimum + record.hits->target[j] * *record.scale;
    const auto at = std::ranges::find_if(record.curve.loss, [&](Real f) { return f <= goal; });
    record.hits->iteration[j] = at == record.curve.loss.end() ? -1 : at - record.curve.loss.begin();
  }
  renew_work(record);
}

// What a record holds beside its figures.
void add_members(Record& record) {
  record.request.rates = "physics.json";
  record.answer = AnswerPoints{.unknowns = 2,
                               .names = {"stiffness", "damping"},
                               .units = {"N/m", "kg/s"},
                               .points = {kReturned},
                               .x = {{1, 2}},
                               .residual_norm = 0};
  record.uncertainty = Uncertainty{.x = {1, 2},
                                   .standard_deviation = {0.1, 0.2},
                                   .correlation = {{1, 0.5}, {0.5, 1}},
                                   .degrees_of_freedom = 4,
                                   .condition = 10};
  renew_answer(record);
  record.failures = Failures{.total = 2, .x = {{3, 4}}, .reasons = {"no root"}};
  const std::size_t points = record.curve.iteration.size();
  record.curve.kkt_residual.assign(points, 0.25);
  record.curve.discrepancy.assign(points, 0.5);
  record.trajectory = Trajectory{};
  for (std::size_t i = 0; i < points; ++i) {
    record.trajectory->x.push_back({1, 2});
    record.trajectory->y.push_back({3, 4});
  }
  record.series["gap"].assign(points, 0.125);
}

Records sound_records() {
  Records all;
  for (const char* problem : {"square", "rosenbrock", "heat", "burgers"})
    for (const char* optimizer : {"gd", "adam", "newton", "gauss-newton"})
      for (std::uint64_t seed = 0; seed < 3; ++seed) {
        Record record = record_of({.problem = problem,
                                   .optimizer = optimizer,
                                   .seed = seed,
                                   .hits = 33 + 6 * seed,
                                   .status = seed == 2 ? Status::target : Status::budget});
        record.request.budget.target = seed == 2 ? 1e-8 : 1e-10;
        record.aim = std::string(problem) == "heat" ? Aim::x : Aim::loss;
        if (record.aim == Aim::x && seed == 2) record.request.budget.target = 1e-4;
        record.cell = cell_digest(record.request);
        record.scale = record.x_scale = 1;
        record.prices[kForward] = 1;
        record.prices[kJacobian] = 4;
        if (std::string(optimizer) == "newton") record.privileges = {"exact inverse"};
        record.build_parts = {{"platform", "p"}, {"harness", "h"}, {"problem", "q"}};
        record.criterion = digest_of(criterion_of(record));
        add_members(record);
        renew_work(record);
        renew_verdicts(record);
        all.push_back(std::move(record));
      }
  return all;
}

struct Fault {
  const char* name;
  std::function<void(Records&)> plant;
  std::set<int> exact, tolerant;  // exit codes
  bool is_refused = false;        // by reports, since the record contradicts itself
  std::function<void(Texts&)> damage = {};
};

// Of one record, of aim loss, or of aim x, that reached its target or not.
std::function<void(Records&)> in_one(const Edit& edit) {
  return [edit](Records& all) { edit(all[1]); };
}
std::function<void(Records&)> in_one_of_x(const Edit& edit) {
  return [edit](Records& all) { edit(all[25]); };
}
std::function<void(Records&)> in_one_that_reached(const Edit& edit) {
  return [edit](Records& all) { edit(all[2]); };
}
std::function<void(Records&)> in_all(const Edit& edit) {
  return [edit](Records& all) {
    for (Record& record : all) edit(record);
  };
}
Edit honest(const Edit& edit) {
  return [edit](Record& record) {
    edit(record);
    renew_verdicts(record);
  };
}
Edit rebuilt(const char* part, const Edit& edit) {
  return [=](Record& record) {
    record.build_parts[part] = "other";
    record.build = "b1";
    edit(record);
  };
}
Edit asked_otherwise(const Edit& edit) {
  return [edit](Record& record) {
    edit(record);
    record.cell = cell_digest(record.request);
  };
}

// The results of one seed under the name of another.
void take_results(Record& to, const Record& from) {
  Record taken = from;
  taken.request = to.request;
  taken.cell = to.cell;
  to = std::move(taken);
}

void jacobian_for_one(Record& record) {
  record.prices[kJacobian] = 1;
  renew_work(record);
}

const std::set<int> kCaught = {kWorse, kNotComparable}, kBad = {kWorse}, kApart = {kNotComparable},
                    kFine = {kGood};

std::vector<Fault> figure_faults() {
  return {
      {"5 % more work", in_one([](Record& r) {
         for (auto& work : r.hits->work) work += work / 20;
       }),
       kCaught, kCaught, true},
      {"one unit more work", in_one([](Record& r) { ++r.hits->work[10]; }), kCaught, kCaught, true},
      {"NaN as loss", in_one([](Record& r) { r.summary.loss = NAN; }), kCaught, kCaught, true},
      {"NaN as best loss", in_one([](Record& r) { r.summary.best_loss = NAN; }), kCaught, kCaught,
       true},
      {"NaN as error in x", in_one([](Record& r) { r.summary.x_error = NAN; }), kCaught, kCaught,
       true},
      {"error in x × 100", in_one([](Record& r) { r.summary.x_error *= 100; }), kCaught, kCaught,
       true},
      {"error in x × 100",
       in_one(honest([](Record& r) { end_in_x_at(r, 100 * r.summary.x_error); })), kBad, kBad},
      {"better loss with worse x", in_one(honest([](Record& r) {
         end_at(r, 0.9 * r.summary.loss);
         end_in_x_at(r, 2 * r.summary.x_error);
       })),
       kBad, kBad},
      {"loss off by 9e-7", in_one(loss_times(1 + 9e-7)), kBad, kFine},
      {"hits removed", in_one([](Record& r) { r.hits.reset(); }), kBad, kBad},
      {"hits ten times as fast", in_one([](Record& r) {
         for (auto* column : {&r.hits->work, &r.hits->iteration})
           for (auto& each : *column)
             if (each > 0) each /= 10;
       }),
       kCaught, kCaught, true},
      {"hits at iteration 1 with 2 units", in_one([](Record& r) {
         std::ranges::fill(r.hits->iteration, 1);
         std::ranges::fill(r.hits->work, 2);
       }),
       kCaught, kCaught, true},
      {"curve's error in x 0", in_one([](Record& r) { std::ranges::fill(r.curve.x_error, 0); }),
       kCaught, kCaught, true},
      {"loss −1 below a declared 0", in_one([](Record& r) { end_at(r, -1); }), kCaught, kCaught,
       true},
      {"verified → false", in_one([](Record& r) { r.verified["1e-3"] = false; }), kCaught, kCaught,
       true},
      {"total work and counts + 1000", in_one([](Record& r) {
         r.summary.work += 1000;
         r.counts[kForward] += 1000;
       }),
       kCaught, kCaught, true},
      {"start loss × 1000", in_one([](Record& r) { r.summary.start_loss *= 1000; }), kCaught,
       kCaught, true},
      {"curve altered at one kept point", in_one([](Record& r) { r.curve.loss[7] *= 1.3; }), kBad,
       kBad},
      {"error in x gone", in_one([](Record& r) {
         r.summary.x_error = r.summary.start_x_error = NAN;
         std::ranges::fill(r.curve.x_error, NAN);
         r.found.clear();
       }),
       kBad, kBad},
      {"error in x and its scale gone", in_one(honest([](Record& r) {
         r.summary.x_error = r.summary.start_x_error = NAN;
         std::ranges::fill(r.curve.x_error, NAN);
         r.x_scale.reset();
       })),
       kApart, kApart},
      {"curve lowered at one kept point", in_one([](Record& r) { r.curve.loss[7] *= 0.7; }), kBad,
       kBad},
      {"extra information: none → exact Hessian",
       in_one([](Record& r) { r.privileges = {"exact Hessian"}; }), kBad, kBad},
      {"extra information gone", in_all([](Record& r) { r.privileges.clear(); }), kBad, kBad},
  };
}

std::vector<Fault> criterion_faults() {
  const Edit raised = honest([](Record& r) {
    r.minimum = r.summary.loss;
    r.scale = 1 - r.summary.loss;
    renew_hits(r);
    r.status = Status::target;
  });
  const Edit widened = honest([](Record& r) {
    r.scale = 1e6;
    renew_hits(r);
  });
  const Edit loss_sought = honest([](Record& r) { r.aim = Aim::loss; });
  return {
      {"f_L raised to the own loss", in_one(raised), kApart, kApart},
      {"f_L raised alone", in_one([](Record& r) { r.minimum = r.summary.loss; }), kApart, kApart,
       true},
      {"scale × 1e6, hits following", in_one(widened), kApart, kApart},
      {"scale alone", in_one([](Record& r) { r.scale = 1e6; }), kApart, kApart, true},
      {"x_floor 10", in_one_of_x(honest([](Record& r) { r.x_floor = 10; })), kApart, kApart},
      {"x_scale × 1e8", in_one_of_x(honest([](Record& r) { r.x_scale = 1e8; })), kApart, kApart},
      {"cost of a Jacobian 4 → 1, work following", in_all(honest(jacobian_for_one)), kApart,
       kApart},
      {"cost alone", in_one([](Record& r) { r.prices[kJacobian] = 1; }), kApart, kApart, true},
      {"cost, from another source", in_all(rebuilt("problem", honest(jacobian_for_one))), kApart,
       kApart},
      {"aim x → loss, from another source", in_one_of_x(rebuilt("problem", loss_sought)), kApart,
       kApart},
  };
}

std::vector<Fault> cell_faults() {
  const auto removed = [](const auto& is_gone) {
    return [=](Records& all) { std::erase_if(all, is_gone); };
  };
  const auto add_double = [](Records& all) {
    all.push_back(all[1]);
    honest(loss_times(1.2))(all.back());
  };
  return {
      {"missing cell", [](Records& all) { all.pop_back(); }, kBad, kBad},
      {"problem removed", removed([](const Record& r) { return r.request.problem.name == "heat"; }),
       kBad, kBad},
      {"optimizer removed",
       removed([](const Record& r) { return r.request.optimizer.name == "adam"; }), kBad, kBad},
      {"one seed fewer", removed([](const Record& r) { return r.request.seed == 2; }), kBad, kBad},
      {"seeds swapped",
       [](Records& all) {
         const Record first = all[0];
         take_results(all[0], all[1]);
         take_results(all[1], first);
       },
       kBad, kBad},
      {"seed 1 := seed 0 everywhere",
       [](Records& all) {
         for (std::size_t i = 1; i < all.size(); i += 3) take_results(all[i], all[i - 1]);
       },
       kBad, kBad},
      {"cut by a clock with a worse loss", in_one(honest([](Record& r) {
         r.is_nondeterministic = true;
         end_at(r, 10 * r.summary.loss);
       })),
       kApart, kApart},
      {"cut by a clock with the same status",
       in_one([](Record& r) { r.is_nondeterministic = true; }), kApart, kApart},
      {"two records of one cell", add_double, kApart, kApart},
      {"seed field edited", in_one([](Record& r) { r.request.seed = 7; }), kCaught, kCaught, true},
      {"budget field edited", in_one([](Record& r) { r.request.budget.iterations = 7; }), kCaught,
       kCaught, true},
      {"declared budget truncated",
       in_one(asked_otherwise([](Record& r) { r.request.budget.iterations = 7; })), kBad, kBad},
      {"changed default with worse work", in_one(asked_otherwise([](Record& r) {
         r.request.optimizer.options.set("epsilon", 1e-2);
         for (auto* column : {&r.curve.iteration, &r.hits->iteration})
           for (auto& each : *column)
             if (each > 0) each *= 2;
         r.summary.iterations *= 2;
         renew_work(r);
       })),
       kBad, kBad},
      {"other platform", in_all(rebuilt("platform", as_it_was)), kApart, kFine},
      {"other platform, where a run fails", in_one(rebuilt("platform", ends_as(Status::failed))),
       kBad, kBad},
      {"damaged file",
       {},
       kBad,
       kBad,
       true,
       [](Texts& texts) { texts[1].resize(texts[1].size() / 2); }},
      {"two columns of different length",
       {},
       kBad,
       kBad,
       true,
       [](Texts& texts) {
         Json json = Json::parse(texts[1]);
         json["curve"]["loss"].erase(0);
         texts[1] = json.dump();
       }},
  };
}

// In members that no figure shows.
std::vector<Fault> member_faults() {
  const auto uncertain = [](const auto& edit) {
    return in_one([edit](Record& r) { edit(*r.uncertainty); });
  };
  return {
      {"returned x + 50 %", in_one([](Record& r) {
         r.uncertainty.reset();
         r.trajectory.reset();
         r.answer->x[0] = {1.5, 3};
       }),
       kCaught, kCaught},
      {"returned x + 50 % alone", in_one([](Record& r) {
         r.answer->x[0] = {1.5, 3};
       }),
       kCaught, kCaught, true},
      {"returned x + 0.1 %", in_all([](Record& r) {
         for (auto* x : {&r.answer->x[0], &r.uncertainty->x, &r.trajectory->x.back()})
           *x = {1.001, 2.002};
       }),
       kBad, kBad},
      {"residual norm × 0.1", in_one([](Record& r) { *r.answer->residual_norm *= 0.1; }), kCaught,
       kCaught, true},
      {"names reversed", in_all([](Record& r) { std::ranges::reverse(r.answer->names); }), kBad,
       kBad},
      {"units changed", in_all([](Record& r) { r.answer->units[0] = "lbf/in"; }), kBad, kBad},
      {"failures removed", in_all([](Record& r) { r.failures.reset(); }), kBad, kBad},
      {"a failed x changed", in_one([](Record& r) { r.failures->x[0][1] = 5; }), kBad, kBad},
      {"verdicts gone", in_one([](Record& r) { r.verified.clear(); }), kBad, kBad},
      {"a verdict unknown", in_one([](Record& r) { r.found.begin()->second.reset(); }), kBad, kBad},
      {"calls at a target that was not reached",
       in_one([](Record& r) { r.hits->counts["jacobian"].back() = 7; }), kBad, kBad},
      {"specification renamed", in_one([](Record& r) { r.request.problem.spec = "squares"; }),
       kApart, kApart, true},
      {"digest of a part of the build", in_one([](Record& r) { r.build_parts["problem"] = "r"; }),
       kApart, kApart},
      {"digests of the parts gone", in_one([](Record& r) { r.build_parts.clear(); }), kApart,
       kApart},
      {"rates renamed", in_all([](Record& r) { r.request.rates = "other.json"; }), kBad, kBad},
      {"standard deviations × 0.1", uncertain([](Uncertainty& u) {
         u.standard_deviation = {0.01, 0.02};
       }),
       kBad, kBad},
      {"variance × 0.01", uncertain([](Uncertainty& u) { u.variance *= 0.01; }), kCaught, kCaught,
       true},
      {"degrees of freedom × 100", uncertain([](Uncertainty& u) { u.degrees_of_freedom *= 100; }),
       kCaught, kCaught, true},
      {"uncertainty removed", in_one([](Record& r) { r.uncertainty.reset(); }), kBad, kBad},
      {"uncertainty at another x", uncertain([](Uncertainty& u) {
         u.x = {5, 6};
       }),
       kCaught, kCaught, true},
      {"noise level", in_one([](Record& r) { r.noise_level = 10; }), kBad, kBad},
      {"a series × 10", in_one([](Record& r) { r.series["gap"].back() *= 10; }), kBad, kBad},
      {"discrepancy × 0.1", in_one([](Record& r) {
         for (Real& each : r.curve.discrepancy) each *= 0.1;
       }),
       kBad, kBad},
      {"KKT residual 0", in_one([](Record& r) { std::ranges::fill(r.curve.kkt_residual, 0); }),
       kBad, kBad},
      {"flag of the best-known loss", in_one([](Record& r) { r.is_best_known = true; }), kBad,
       kBad},
      {"trajectory", in_one([](Record& r) {
         r.trajectory->y[3] = {3, 5};
       }),
       kBad, kBad},
      {"success criterion emptied", in_one([](Record& r) { r.criterion.clear(); }), kCaught,
       kCaught},
      {"an additional record that is not its request's",
       [](Records& all) {
         all.push_back(all[0]);
         all.back().cell = "0123456789abcdef";
       },
       kApart, kApart, true},
  };
}

std::vector<Fault> changes_without_harm() {
  return {
      {"target → converged", in_one_that_reached(ends_as(Status::converged)), kFine, kFine},
      {"NaN as times", in_all([](Record& r) { std::ranges::fill(r.curve.wall_seconds, NAN); }),
       kFine, kFine},
      {"a record that the plan does not hold",
       [](Records& all) {
         all.push_back(all[0]);
         all.back().request.seed = 9;
         all.back().cell = cell_digest(all.back().request);
       },
       kFine, kFine},
      {"a changed default with the same figures",
       in_one(asked_otherwise([](Record& r) { r.request.optimizer.options.set("epsilon", 1e-2); })),
       kFine, kFine},
      {"a copy", [](Records&) {}, kFine, kFine},
      {"other order of files", [](Records& all) { std::ranges::reverse(all); }, kFine, kFine},
      {"rounding by 1e-12", in_all(honest([](Record& r) {
         for (Real& loss : r.curve.loss) loss *= 1 + 1e-12;
         for (Real* loss : {&r.summary.loss, &r.summary.best_loss, &r.summary.start_loss})
           *loss *= 1 + 1e-12;
       })),
       kCaught, kFine},
      {"times × 3", in_all([](Record& r) {
         for (Real& seconds : r.curve.wall_seconds) seconds *= 3;
         for (Real& seconds : r.hits->wall_seconds) seconds *= 3;
         r.summary.wall_seconds *= 3;
       }),
       kFine, kFine},
      {"asked in other words", in_one([](Record& r) { r.request.problem.asked = "square[]"; }),
       kFine, kFine},
      {"other start time and command", in_all([](Record& r) {
         r.provenance.run.started = "2027-01-01T00:00:00Z";
         r.provenance.run.command = "isoline run again";
       }),
       kFine, kFine},
      {"memory × 2", in_all([](Record& r) { r.summary.peak_memory_bytes = 1 << 20; }), kFine,
       kFine},
      {"other processor", in_all([](Record& r) {
         Build other = *r.provenance.build;
         other.processor = "another";
         r.provenance = Provenance(std::make_shared<const Build>(other), r.provenance.run);
       }),
       kFine, kFine},
      {"other harness with equal figures", in_all(rebuilt("harness", as_it_was)), kApart, kFine},
  };
}

// Files are named by their place: a double would otherwise take the place of the first.
void write(const ResultFolder& folder, const Records& records,
           const std::function<void(Texts&)>& damage = {}) {
  Texts texts;
  for (const Record& record : records) texts.push_back(file_text(record));
  if (damage) damage(texts);
  for (std::size_t i = 0; i < texts.size(); ++i)
    folder.add_file("runs/" + std::to_string(1000 + i) + ".json", texts[i]);
}

class Faults : public testing::Test {
 protected:
  Faults() { write(before_, sound_records()); }

  void expect(const std::vector<Fault>& faults) const {
    for (const Fault& fault : faults) {
      SCOPED_TRACE(fault.name);
      Records records = sound_records();
      if (fault.plant) fault.plant(records);
      const ResultFolder after;
      write(after, records, fault.damage);
      const GateResult exact = compare_results(before_.path(), after.path(), {}),
                       tolerant =
                           compare_results(before_.path(), after.path(), {.tolerance = 1e-6});
      EXPECT_TRUE(fault.exact.contains(exact.exit_code)) << exact.verdict;
      EXPECT_TRUE(fault.tolerant.contains(tolerant.exit_code)) << tolerant.verdict;
      const Study study = read_study({after.path()});
      EXPECT_EQ(!study.unreadable.empty(), fault.is_refused);
      for (const Unreadable& file : study.unreadable) EXPECT_FALSE(file.reason.empty());
    }
  }

  ResultFolder before_;
};

TEST_F(Faults, AreNotInTheResultsThatTheyArePlantedInto) {
  for (const Record& record : sound_records())
    EXPECT_EQ(broken_invariants(record), std::vector<std::string>()) << record.cell;
}

// What no run can write is refused by every reader, even where no comparison depends on it.
TEST_F(Faults, InTimesCountsAndTargetsBreakAnInvariantEach) {
  const std::vector<std::pair<const char*, Edit>> edits = {
      {"processor time", [](Record& r) { r.summary.processor_seconds = -1; }},
      {"memory", [](Record& r) { r.summary.peak_memory_bytes = -1; }},
      {"rejected steps", [](Record& r) { r.summary.rejected_steps = -1; }},
      {"counts", [](Record& r) { r.counts[kJacobian] = -1; }},
      {"order of times", [](Record& r) { std::ranges::reverse(r.curve.wall_seconds); }},
      {"times of hits", [](Record& r) { r.hits->wall_seconds[0] = -1; }},
      {"forwards of hits", [](Record& r) { ++r.hits->forwards[2]; }},
      {"cell", [](Record& r) { r.cell = std::string(16, '0'); }},
      {"seed", [](Record& r) { ++r.request.seed; }},
      {"budget", [](Record& r) { r.request.budget.stall = 0; }},
      {"targets of hits", [](Record& r) { r.hits->target[2] /= 2; }}};
  for (const auto& [name, edit] : edits) {
    Record record = sound_records()[2];
    edit(record);
    EXPECT_FALSE(broken_invariants(record).empty()) << name;
  }
}

TEST_F(Faults, InFiguresAreCaught) { expect(figure_faults()); }
TEST_F(Faults, InTheCriterionOfSuccessAreCaught) { expect(criterion_faults()); }
TEST_F(Faults, InCellsAreCaught) { expect(cell_faults()); }
TEST_F(Faults, InMembersThatNoFigureShowsAreCaught) { expect(member_faults()); }

TEST_F(Faults, InTheFamilyAndTheKindOfAProblemAreCaught) {
  const Json sheet = {{"family", "laplacian"}, {"linear", true}, {"unknowns", 4}};
  for (const auto& [member, other] :
       std::map<std::string, Json>{{"family", "own"}, {"linear", false}, {"unknowns", 5}}) {
    const ResultFolder base, copy;
    Json changed = sheet;
    for (const ResultFolder* folder : {&base, &copy}) {
      write(*folder, sound_records());
      folder->add_file("components/problem-p.json", changed.dump());
      changed[member] = other;
    }
    EXPECT_EQ(compare_results(base.path(), copy.path(), {}).exit_code, kWorse) << member;
    EXPECT_EQ(compare_results(base.path(), base.path(), {}).exit_code, kGood) << member;
  }
}

TEST_F(Faults, AMissingComponentFileIsCaughtWhereItsRunsAreThere) {
  const ResultFolder base, copy;
  for (const ResultFolder* folder : {&base, &copy}) write(*folder, sound_records());
  for (const char* spec : {"square", "not-run"})
    base.add_file(std::string("components/problem-") + spec + ".json", Json{{"spec", spec}}.dump());
  EXPECT_EQ(compare_results(base.path(), copy.path(), {}).exit_code, kWorse);
  copy.add_file("components/problem-of-another-name.json", Json{{"spec", "square"}}.dump());
  EXPECT_EQ(compare_results(base.path(), copy.path(), {}).exit_code, kGood);
}

TEST_F(Faults, InThePlanAndTheRatesOfAFolderAreCaught) {
  const ResultFolder base, copy;
  write(base, sound_records());
  write(copy, sound_records());
  Records half = sound_records();
  base.add(plan_of(half));
  half.resize(half.size() / 2);
  copy.add(plan_of(half));
  EXPECT_EQ(compare_results(base.path(), copy.path(), {}).exit_code, kWorse);
  copy.add(plan_of(sound_records()));
  EXPECT_EQ(compare_results(base.path(), copy.path(), {}).exit_code, kGood);
  base.add_file("rates.json", "{}");
  EXPECT_EQ(compare_results(base.path(), copy.path(), {.tolerance = 1e-6}).exit_code, kWorse);
}

TEST_F(Faults, ThatChangeNoResultAreNone) { expect(changes_without_harm()); }

TEST_F(Faults, AWorseStatusIsWorse) {
  std::vector<Fault> faults;
  for (const Status status :
       {Status::budget, Status::crashed, Status::interrupted, Status::inapplicable,
        Status::diverged, Status::timeout, Status::failed})
    faults.push_back({name_of(status).data(), in_one_that_reached(ends_as(status)), kBad, kBad});
  expect(faults);
}

TEST_F(Faults, ACriterionThatIsAllowedToDifferIsComparedAndNamed) {
  Records records = sound_records();
  for (Record& record : records) honest(jacobian_for_one)(record);
  const ResultFolder after;
  write(after, records);
  const GateResult strict = compare_results(before_.path(), after.path(), {.tolerance = 1e-6});
  EXPECT_TRUE(has(strict.verdict, "jacobian 4 → 1")) << strict.verdict;
  const GateResult allowed = compare_results(
      before_.path(), after.path(),
      {.tolerance = 1e-6,
       .allowed = {{.problem = "*", .reason = "cheaper Jacobians", .is_of_criterion = true}}});
  EXPECT_EQ(allowed.exit_code, kBetterOnly) << "the same calls are less work";
  EXPECT_EQ(allowed.allowed.size(), records.size());
}

// The line of a cell in a baseline holds the criterion too.
TEST_F(Faults, ABaselineHoldsTheCriterion) {
  const ResultFolder base, after;
  base.add_file("baseline.json", baseline_json(read_study({before_.path()})));
  Records records = sound_records();
  honest([](Record& r) { r.x_floor = 10; })(records[25]);
  records[1].privileges = {"exact Hessian"};
  write(after, records);
  const GateResult result =
      compare_results(base.path() / "baseline.json", after.path(), {.tolerance = 1e-6});
  EXPECT_EQ(result.exit_code, kWorse);
  EXPECT_EQ(result.differences.at(0).what, "extra information");
  ASSERT_EQ(result.incomparable.size(), 1U);
  EXPECT_TRUE(has(result.incomparable[0].reason, "floor of"));
}

// Records of before the digest are judged by what they hold.
TEST_F(Faults, AnOlderRecordWithoutADigestIsReadAndCompared) {
  Records records = sound_records();
  for (Record& record : records) record.criterion.clear();
  const ResultFolder older;
  write(older, records);
  EXPECT_EQ(compare_results(older.path(), before_.path(), {.tolerance = 1e-6}).exit_code, kGood);
  EXPECT_TRUE(read_study({older.path()}).unreadable.empty());
}

}  // namespace
}  // namespace isoline::reports
