// A point is worth what a fresh problem says of it, whatever its cell has done to its own.
#include "benchmarks/run/judge.h"

#include "tests/benchmarks/hostile.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
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

// How often the trap has been made, in whatever process, and has failed in this one.
std::atomic<int>& times_made() { return told(); }
int times_failed = 0;

// y = x, made well for its cell, which comes first, and ill for the judges after it.
struct TrapOptions {
  std::string deed = "crash-once";
};
void fields(TrapOptions& o, auto& field) {
  field("deed", o.deed, Choices{"crash-once", "crash", "hang", "throw", "fail-once", "killed"},
        "what befalls a judge");
}
ProblemParts make_trap(const TrapOptions& o, const Draw&) {
  const int times = ++times_made();
  if (o.deed == "crash-once" && times == 2) std::raise(SIGSEGV);
  if (o.deed == "crash" && times > 1) std::raise(SIGSEGV);
  if (o.deed == "killed" && times > 1) std::raise(SIGKILL);
  if (o.deed == "throw" && times > 1) throw std::runtime_error("no second instance");
  while (o.deed == "hang" && times > 1) pause();
  const auto value = [fails_once = o.deed == "fail-once"](VectorRef x) -> Vector {
    if (fails_once && x[0] == 2 && ++times_failed == 1) throw std::runtime_error("no value");
    return x;
  };
  return {.physics = physics_of(1, 1, value, [](VectorRef) { return Matrix::Ones(1, 1).eval(); }),
          .start = Vector::Ones(1),
          .target = Vector::Zero(1),
          .minimum = 0};
}

Catalog catalog_of_judges() {
  Catalog catalog = hostile_catalog();
  catalog.optimizers.add(stepper_entry<Cheat>({.name = "cheat", .needs = {Oracle::forward}}));
  catalog.problems.add(problem_entry({.name = "trap"}, make_trap));
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
  std::vector<Verdict> verdicts_on(const std::vector<Real>& points, const std::string& deed,
                                   const Limits& limits = {}) {
    std::vector<Worker> workers(points.size());
    Judges judges(catalog, workers);
    const Request request = asked("trap", {{"deed", deed}}, "gd", {});
    for (std::size_t slot = 0; slot < workers.size(); ++slot) {
      workers[slot].keep_returned(std::vector<Real>{points[slot]});
      judges.ask(slot, request, limits);
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

TEST_F(Judging, AJudgeThatDiesOfAProblemOrCannotMakeItCostsItsCellAlone) {
  const Request sound = asked("square", {}, "gd", {});
  for (const auto& [deed, reason] : std::map<std::string, std::string>{
           {"crash", "signal 11"}, {"throw", "no second instance"}}) {
    times_made() = 0;
    const Request trap = asked("trap", {{"deed", deed}}, "gd", {{"rate", 1.0}});
    const Outcome outcome = run_all(catalog, {trap, sound}, store, {.jobs = 2, .force = true});
    EXPECT_EQ(outcome.failures.size(), 1U);
    const Record record = store.find(trap).value_or(Record{});
    EXPECT_EQ(record.status, Status::failed);
    EXPECT_NE(record.message.find(reason), std::string::npos) << record.message;
    EXPECT_EQ(store.find(sound).value_or(Record{}).status, Status::budget);
  }
}

TEST_F(Judging, AJudgeThatHangsIsGivenUp) {
  constexpr double kPatience = 0.2;
  times_made() = 1;
  const Verdict verdict =
      verdicts_on({1}, "hang", {.startup_seconds = kPatience, .hard_seconds = kPatience}).at(0);
  EXPECT_FALSE(verdict.judged.has_value());
  EXPECT_EQ(verdict.failure, "it took more than 0.2 s");
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
