// A point is worth what a fresh problem says of it, whatever its cell has done to its own.
#include "benchmarks/run/judge.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <csignal>

#include "benchmarks/run/runner.h"
#include "problems/dense_physics.h"
#include "tests/benchmarks/hostile.h"
#include "tests/deadline.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using problems::DensePhysics;
namespace {

// Stays where it started, and makes a solution of it by changing what is asked.
struct Cheat {
  std::string deed = "nothing";
  struct State {
    Linearization at;
  };
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    f.linearize(theta, s.at);
    if (deed == "target") const_cast<Matrix&>(f.target()) = s.at.y();
    return Status::converged;
  }
};
void fields(Cheat& o, auto& field) {
  field("deed", o.deed, Choices{"nothing", "target"}, "what it does to its problem");
}

// How often the trap has been made, and has failed, in whatever process.
int* shared_counts() {
  static auto* const shared = static_cast<int*>(
      mmap(nullptr, 2 * sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  return shared;
}
int& times_made() { return shared_counts()[0]; }
int& times_failed() { return shared_counts()[1]; }

// y = x, made well for its cell, which comes first, and ill for the judges after it.
struct TrapOptions {
  std::string deed = "crash-once";
};
void fields(TrapOptions& o, auto& field) {
  field("deed", o.deed, Choices{"crash-once", "crash", "hang", "throw", "fail-once", "killed"},
        "what befalls a judge");
}
class Trap final : public DensePhysics {
 public:
  explicit Trap(bool fails_once) : DensePhysics(1, 1), fails_once_(fails_once) {}
  void value(VectorRef x, VectorOut y) const override {
    if (fails_once_ && x[0] == 2 && ++times_failed() == 1) throw std::runtime_error("no value");
    y = x;
  }
  void derivative(VectorRef, BatchOut J) const override { J(0, 0) = 1; }

 private:
  bool fails_once_;
};
ProblemParts make_trap(const TrapOptions& o, const Draw&) {
  const int times = ++times_made();
  if (o.deed == "crash-once" && times == 2) std::raise(SIGSEGV);
  if (o.deed == "crash" && times > 1) std::raise(SIGSEGV);
  if (o.deed == "killed" && times > 1) std::raise(SIGKILL);
  if (o.deed == "throw" && times > 1) throw std::runtime_error("no second instance");
  while (o.deed == "hang" && times > 1) pause();
  return {.physics = std::make_unique<Trap>(o.deed == "fail-once"),
          .start = Vector::Ones(1),
          .target = Vector::Zero(1),
          .minimum = 0};
}

Catalog catalog_of_judges() {
  Catalog catalog = hostile_catalog();
  catalog.optimizers.add(stepper_entry<Cheat>({.name = "cheat",
                                               .title = "Changes what is asked",
                                               .formula = "none",
                                               .source = "here",
                                               .needs = {Oracle::forward}}));
  catalog.problems.add(problem_entry(
      {.name = "trap", .title = "Made once", .formula = "none", .source = "here"}, make_trap));
  return catalog;
}

class Judging : public testing::Test {
 protected:
  Request asked(const std::string& problem, const OptionValues& of_problem,
                const std::string& optimizer, const OptionValues& options) {
    return request_for(catalog, problem, of_problem, optimizer, options);
  }
  Record record_after(const Request& request) {
    run_all(catalog, {request}, store, {});
    return store.find(request).value_or(Record{});
  }
  Record record_of_trap(const std::string& deed) {
    times_made() = 0;
    return record_after(asked("trap", {{"deed", deed}}, "gd", {{"rate", 1.0}}));
  }

  // On points of one trap, in order.
  std::vector<Verdict> verdicts_on(const std::vector<Real>& points, const std::string& deed) {
    std::vector<Worker> workers(points.size());
    Judges judges(catalog, workers);
    const Request request = asked("trap", {{"deed", deed}}, "gd", {});
    for (std::size_t slot = 0; slot < workers.size(); ++slot) {
      workers[slot].keep_returned(std::vector<Real>{points[slot]});
      judges.ask(slot, request, {});
    }
    std::vector<Verdict> all;
    wait_until([&] {
      for (const Verdict& verdict : judges.collect()) all.push_back(verdict);
      return all.size() == workers.size();
    });
    return all;
  }

  Catalog catalog = catalog_of_judges();
  TemporaryFolder folder;
  Store store{folder.path()};
};

TEST_F(Judging, APointThatIsNoneButInItsOwnProcessIsAFailure) {
  const Record record = record_after(asked("square", {}, "cheat", {{"deed", "target"}}));
  EXPECT_EQ(record.status, Status::failed);
  EXPECT_NE(record.message.find("its loss is 90 on a new instance"), std::string::npos)
      << record.message;
  for (const auto& [tau, is_verified] : record.verified) EXPECT_EQ(is_verified, false) << tau;
}

TEST_F(Judging, AnHonestPointStands) {
  EXPECT_EQ(record_after(asked("square", {}, "cheat", {})).status, Status::converged);
  EXPECT_EQ(record_after(asked("square", {}, "gauss-newton", {})).status, Status::target);
}

TEST_F(Judging, AJudgeThatDiesOnceIsReplacedAndAskedAgain) {
  EXPECT_EQ(record_of_trap("crash-once").status, Status::target);
  EXPECT_EQ(times_made(), 3);
}

TEST_F(Judging, AJudgeThatDiesOfAProblemCostsItsCellAlone) {
  times_made() = 0;
  const Request trap = asked("trap", {{"deed", "crash"}}, "gd", {{"rate", 1.0}});
  const Request sound = asked("square", {}, "gd", {});
  const Outcome outcome = run_all(catalog, {trap, sound}, store, {.jobs = 2});
  EXPECT_EQ(outcome.failures.size(), 1U);
  const Record record = store.find(trap).value_or(Record{});
  EXPECT_EQ(record.status, Status::failed);
  EXPECT_NE(record.message.find("signal 11"), std::string::npos) << record.message;
  EXPECT_EQ(store.find(sound).value_or(Record{}).status, Status::budget);
}

TEST_F(Judging, WhyAJudgeCouldNotMakeTheProblemIsSaid) {
  const Record record = record_of_trap("throw");
  EXPECT_EQ(record.status, Status::failed);
  EXPECT_NE(record.message.find("no second instance"), std::string::npos) << record.message;
}

TEST_F(Judging, AJudgeThatHangsIsGivenUp) {
  constexpr double kPatience = 0.2;
  times_made() = 1;
  std::vector<Worker> workers(1);
  workers[0].keep_returned(std::vector<Real>{1});
  Judges judges(catalog, workers);
  const Request request = asked("trap", {{"deed", "hang"}}, "gd", {});
  judges.ask(0, request, {.startup_seconds = kPatience, .hard_seconds = kPatience});
  std::vector<Verdict> verdicts;
  wait_until([&] {
    verdicts = judges.collect();
    return !verdicts.empty();
  });
  EXPECT_FALSE(verdicts[0].judged.has_value());
  EXPECT_EQ(verdicts[0].failure, "it took more than 0.2 s");
}

TEST_F(Judging, ManyPointsOfOneProblemAreJudgedByOneProcess) {
  times_made() = 2;
  const std::vector<Verdict> all = verdicts_on({0, 1, 2}, "crash-once");
  for (std::size_t slot = 0; slot < all.size(); ++slot) {
    ASSERT_TRUE(all[slot].judged.has_value()) << all[slot].failure;
    EXPECT_EQ(all[slot].slot, slot);
    EXPECT_EQ(all[slot].judged->loss, 0.5 * static_cast<Real>(slot * slot));
  }
  EXPECT_EQ(times_made(), 3);
}

// The second would be told the loss at the start, where the first was left.
TEST_F(Judging, AnInstanceThatFailedAnswersNobodyElse) {
  times_failed() = 0;
  for (const Verdict& verdict : verdicts_on({2, 2}, "fail-once")) {
    ASSERT_TRUE(verdict.judged.has_value()) << verdict.failure;
    EXPECT_EQ(verdict.judged->loss, 2);
  }
}

TEST_F(Judging, APointWhoseJudgesWereKilledIsInterruptedAndRunsAgain) {
  const Record record = record_of_trap("killed");
  EXPECT_FALSE(store.find(record.request).has_value());
  times_made() = 0;
  const Request trap = asked("trap", {{"deed", "killed"}}, "gd", {{"rate", 1.0}});
  const Outcome outcome = run_all(catalog, {trap}, store, {});
  EXPECT_EQ(outcome.run, 1) << "it was not done";
  EXPECT_EQ(outcome.interrupted, 1);
  EXPECT_TRUE(outcome.failures.empty());
}

TEST(Contradictions, RoundingIsNoneAndWhatIsNotFiniteMustBeSoInBoth) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const Judged one{.loss = 2, .x_error = nan, .minimum = 0, .scale = 1, .x_scale = nan};
  Judged other = one;
  other.loss = 2 + 1e-13;
  EXPECT_EQ(contradiction(one, other), "");
  other.loss = 2 + 1e-6;
  EXPECT_NE(contradiction(one, other), "");
  other = one;
  other.x_error = infinity;
  EXPECT_EQ(contradiction(one, other), "");
  other.x_error = 0;
  EXPECT_NE(contradiction(one, other), "");
}

}  // namespace
}  // namespace isoline::benchmarks
