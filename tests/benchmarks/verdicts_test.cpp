// The harness itself judges a run: what is verified, which targets were reached, and what a method
// claims. A start far out or a run to infinity is never called solved.
#include <cmath>

#include "benchmarks/run/judge.h"
#include "core/status.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/hostile.h"
#include "tests/benchmarks/matrix.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
using optimizers::Family;
using optimizers::Linearization;
using optimizers::stepper_entry;
using problems::ProblemParts;

namespace {

// Problems that are solved, crawled at and never solved, with every optimizer.
const FinishedMatrix& judged_matrix() {
  static const FinishedMatrix all(
      catalog(),
      {.name = "verdicts",
       .title = "",
       .blocks = {{.problems = {"square", "rosenbrock", "brown-dennis", "brown-dennis[m=10]",
                                "sine", "helical-valley", "broyden-tridiagonal"},
                   .optimizers = {"*"},
                   .seeds = {0, 3},
                   .budget = {.iterations = 1000, .work = 3000}}}},
      Rates::builtin());
  return all;
}

bool is_met(const Record& record, Real loss, Real tau) {
  return std::isfinite(loss) && loss <= *record.minimum + tau * *record.scale;
}

// What a run is stopped at.
bool meets_target(const Record& record) {
  const Real tau = record.request.budget.target;
  if (record.aim == Aim::loss) return is_met(record, record.summary.loss, tau);
  return record.summary.x_error <= x_goal(tau, *record.x_scale, record.x_floor);
}

TEST(Verdicts, VerifiedAndFoundAreWhatTheReturnedPointMeets) {
  std::size_t met = 0, missed = 0, found_there = 0, lost = 0, without_minimum = 0;
  for (const Record& record : judged_matrix().records) {
    SCOPED_TRACE(title_of(record));
    EXPECT_EQ(record.hits.has_value(), record.minimum.has_value());
    without_minimum += !record.minimum;
    for (const auto& [name, tau] : kVerified) {
      const std::optional<bool> verified = record.verified.at(name), found = record.found.at(name);
      EXPECT_EQ(verified.has_value(), record.minimum.has_value());
      EXPECT_EQ(found.has_value(), record.x_scale.has_value());
      if (verified) {
        EXPECT_EQ(*verified, is_met(record, record.summary.loss, tau)) << name;
        (*verified ? met : missed) += 1;
      }
      if (found) {
        const Real goal = x_goal(tau, *record.x_scale, record.x_floor);
        EXPECT_EQ(*found, record.summary.x_error <= goal) << name;
        (*found ? found_there : lost) += 1;
      }
    }
  }
  for (const std::size_t many : {met, found_there}) EXPECT_GT(many, 50U);
  for (const std::size_t some : {missed, lost}) EXPECT_GT(some, 20U);
  EXPECT_GT(without_minimum, 0U);  // brown-dennis[m=10]
}

TEST(Verdicts, TargetIsTheVerdictWhereverTheTargetIsMet) {
  for (const Record& record : judged_matrix().records) {
    if (!record.minimum) {
      EXPECT_NE(record.status, Status::target) << title_of(record);
      continue;
    }
    if (record.status == Status::inapplicable) continue;
    EXPECT_EQ(record.status == Status::target, meets_target(record))
        << title_of(record) << " is " << name_of(record.status);
  }
}

// A loss of 1e-20 was at 2.3e-5 of x.
TEST(Verdicts, WhereXIsSoughtAMethodThatConvergesGoesOnUntilItIsFound) {
  std::size_t count = 0;
  for (const Record& record : judged_matrix().records) {
    const std::string& method = record.request.optimizer.name;
    if (record.aim != Aim::x || record.request.seed != 0) continue;
    if (method != "newton" && method != "gauss-newton" && method != "ceres-lm") continue;
    EXPECT_EQ(record.found.at("1e-6"), true) << title_of(record);
    ++count;
  }
  EXPECT_EQ(count, 3U);
}

TEST(Verdicts, NameWhatTheUserWantsAndTheScaleIsThatOfTheProblemWhateverTheDrawnStart) {
  constexpr Real kPublished = 24.2 / 2;  // ½Σf² of rosenbrock at (−1.2, 1)
  std::size_t scaled = 0;
  for (const Record& record : judged_matrix().records) {
    const std::string& problem = record.request.problem.name;
    const Aim aim = catalog().problems.at(problem).aim;
    EXPECT_EQ(aim, problem == "square" ? Aim::x : Aim::loss);
    if (record.status != Status::inapplicable) {
      EXPECT_EQ(record.aim, aim) << title_of(record);
    }
    if (problem != "rosenbrock" || !record.scale) continue;
    EXPECT_LE(*record.scale, kPublished * (1 + 1e-12));
    ++scaled;
  }
  EXPECT_GT(scaled, 0U);
}

// Ours say at most by which of their ways they made their steps, or why they stalled.
TEST(Verdicts, LibrariesClaimSuccessAndOurMethodsDoNot) {
  for (const Record& record : judged_matrix().records) {
    if (record.status == Status::inapplicable) continue;
    const Family family = catalog().optimizers.at(record.request.optimizer.name).family;
    constexpr std::array kLibraries = {Family::ceres, Family::nlopt, Family::nlopt_derivative_free,
                                       Family::minpack, Family::gsl};
    const bool is_library = std::ranges::find(kLibraries, family) != kLibraries.end();
    const bool is_reason =
        record.claimed.starts_with("steps by ") || record.status == Status::stalled;
    EXPECT_EQ(is_library, !record.claimed.empty() && (is_library || !is_reason))
        << title_of(record) << ": " << record.claimed;
  }
}

// The hits, of the loss or of the error in x, where `is_met(value, τ)` says what they are of.
template <class Met>
void expect_in_order(const Record& record, const Hits& hits, const std::vector<Real>& curve,
                     const Met& is_met) {
  ASSERT_EQ(hits.target.size(), 51U) << title_of(record);
  for (std::size_t j = 0; j < hits.target.size(); ++j) {
    SCOPED_TRACE(title_of(record) + ", target " + std::to_string(j));
    const bool is_hit = hits.iteration[j] >= 0;
    EXPECT_NEAR(std::log10(hits.target[j]), -static_cast<Real>(j) / 5, 1e-12);  // rounding
    EXPECT_EQ(is_hit, hits.work[j] >= 0);
    EXPECT_EQ(is_hit, hits.forwards[j] >= 0);
    for (std::size_t i = 0; i < curve.size(); ++i) {
      if (!is_met(curve[i], hits.target[j])) continue;
      EXPECT_TRUE(is_hit);
      EXPECT_LE(hits.iteration[j], record.curve.iteration[i]);
      EXPECT_LE(hits.work[j], record.curve.work[i]);
      break;
    }
    if (!is_hit) continue;
    std::int64_t work = 0;  // of every oracle
    for (std::size_t kind = 0; kind < kOracles; ++kind) {
      const auto column = hits.counts.find(std::string(kOracleNames[kind]));
      if (column != hits.counts.end()) work += record.prices[kind] * column->second[j];
    }
    EXPECT_EQ(work, hits.work[j]);
    if (j == 0) continue;
    EXPECT_GE(hits.iteration[j - 1], 0);
    EXPECT_GE(hits.iteration[j], hits.iteration[j - 1]);
    EXPECT_GE(hits.work[j], hits.work[j - 1]);
    EXPECT_GE(hits.forwards[j], hits.forwards[j - 1]);
    EXPECT_GE(hits.wall_seconds[j], hits.wall_seconds[j - 1]);
  }
}

TEST(Hits, ComeInOrderWithTheirWorkAndAsTheBestLossAndTheCurveHaveThem) {
  std::size_t in_x = 0;
  for (const Record& record : judged_matrix().records) {
    const bool is_run = record.status != Status::inapplicable;
    EXPECT_EQ(record.x_hits.has_value(), is_run && record.aim == Aim::x &&
                                             record.x_scale.has_value() &&
                                             !record.request.problem.is_learned)
        << title_of(record);
    if (record.x_hits) {
      ++in_x;
      expect_in_order(record, *record.x_hits, record.curve.x_error, [&](Real error, Real tau) {
        return error <= x_goal(tau, *record.x_scale, record.x_floor);
      });
    }
    if (!record.hits) continue;
    expect_in_order(record, *record.hits, record.curve.loss,
                    [&](Real loss, Real tau) { return is_met(record, loss, tau); });
    for (std::size_t j = 0; j < record.hits->target.size(); ++j)
      EXPECT_EQ(record.hits->iteration[j] >= 0,
                is_met(record, record.summary.best_loss, record.hits->target[j]))
          << title_of(record);
  }
  EXPECT_GT(in_x, 0U);
}

// --- runs that diverge

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();

// Jumps to `to` at once and stays; optionally evaluates the loss there.
struct Jump {
  Real to = 0;
  bool asks = true;
  struct State {
    Linearization at;
  };
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State& s) const {
    theta.setConstant(to);
    if (asks) f.linearize(theta, s.at);
    return Status::converged;
  }
};
void fields(Jump& o, auto& field) {
  field("to", o.to, any(), "each component of θ");
  field("asks", o.asks, "whether it asks for the loss there");
}

const Catalog& with_escapes() {
  static const Catalog catalog = [] {
    Catalog all = builtin_catalog();
    const auto add = [&](const char* name, const std::function<ProblemParts()>& parts) {
      all.problems.add({.name = name, .make = [parts](const OptionValues&, const problems::Draw&) {
                          return Problem(parts());
                        }});
    };
    const auto one = [](Real y) { return Vector(Vector::Constant(1, y)); };
    // y = eˣ − 0.35 against y* = 0: the least of ½y² is 0 at log 0.35. A start that a draw has
    // thrown to 123, where ½y² = 1e106; the standard one is 0.
    add("cliff", [=]() -> ProblemParts {
      return {.physics = physics_of(
                  1, 1, [=](VectorRef x) { return one(std::exp(x[0]) - 0.35); },
                  [=](VectorRef x) { return one(std::exp(x[0])); }),
              .start = {one(123), one(0)},
              .target = one(0),
              .minimum = 0};
    });
    // y = (1, x)/(1 + x²) tends to 0 at infinity, where the loss is three times the minimum, as
    // with MGH09 of NIST from its first start. At infinity f = ½·(0.3² + 0.1²) = 0.05, at the start
    // 0.85.
    add("plateau", [=]() -> ProblemParts {
      return {
          .physics = physics_of(
              1, 2,
              [](VectorRef x) -> Vector { return Eigen::Vector2d(1, x[0]) / (1 + x[0] * x[0]); },
              [](VectorRef x) -> Vector {
                return Eigen::Vector2d(-2 * x[0], 1 - x[0] * x[0]) / std::pow(1 + x[0] * x[0], 2);
              }),
          .start = one(0),
          .target = Eigen::Vector2d(-0.3, 0.1),
          .minimum = 0.05 / 3};
    });
    // ½y² is infinite at the start, and wherever x > 0.
    add("wall", [=]() -> ProblemParts {
      return {.physics = physics_of(
                  1, 1, [=](VectorRef x) { return one(x[0] > 0 ? kInfinity : x[0] - 1); },
                  [=](VectorRef) { return one(1); }),
              .start = one(1),
              .target = one(1),
              .minimum = 0};
    });
    all.optimizers.add(stepper_entry<Jump>({.name = "jump", .needs = {Oracle::forward}}));
    return all;
  }();
  return catalog;
}

Request jump_on(const std::string& problem, Real to, bool asks) {
  return named(
      {.problem = complete_problem(with_escapes(), problem, OptionValues()),
       .optimizer = complete_optimizer(with_escapes(), "jump", {{"to", to}, {"asks", asks}}),
       .budget = {.iterations = 5}});
}

Record run(const std::string& problem, Real to, bool asks = true) {
  return executed(with_escapes(), jump_on(problem, to, asks));
}

std::size_t hits_of(const Record& record) {
  std::size_t met = 0;
  for (const std::int64_t iteration : record.hits->iteration) met += iteration >= 0;
  return met;
}

TEST(Escapes, OfAStartAtTenToTheHundredSixVerifyNothing) {
  const Record far = run("cliff", 100);  // from 1e106 down to 1e86
  EXPECT_GT(far.summary.start_loss, 1e105);
  EXPECT_LT(far.summary.loss, 1e-19 * far.summary.start_loss);
  EXPECT_EQ(far.verified.at("1e-1"), false);
  EXPECT_EQ(hits_of(far), 0U);
  EXPECT_NEAR(*far.scale, 0.5 * 0.65 * 0.65, 1e-15);  // ½(e⁰ − 0.35)², at the standard start
  const Record near = run("cliff", std::log(0.35));
  EXPECT_EQ(near.verified.at("1e-6"), true);
  EXPECT_EQ(near.status, Status::target);
}

TEST(Escapes, OfAMethodThatAsksNothingCostTheForwardOfTheirPoint) {
  for (const bool asks : {true, false}) {
    const Record near = run("cliff", std::log(0.35), asks);
    EXPECT_EQ(near.status, Status::target);
    EXPECT_EQ(near.summary.work, 1) << asks;
    EXPECT_EQ(near.hits->work.at(50), 1) << asks;
  }
}

TEST(Escapes, ToAPlateauOfThriceTheLeastLossVerifyNothing) {
  const Record escaped = run("plateau", 1e9);
  EXPECT_NEAR(escaped.summary.loss, 0.05, 1e-9);
  EXPECT_GT(escaped.summary.start_loss, 10 * escaped.summary.loss);
  EXPECT_EQ(*escaped.scale, *escaped.minimum);  // the data's own residual
  EXPECT_EQ(escaped.verified.at("1e-1"), false);
  EXPECT_EQ(hits_of(escaped), 0U);
}

TEST(Escapes, ALossThatIsNotFiniteIsNeitherVerifiedNorHit) {
  const Record stayed = run("wall", 2);
  EXPECT_FALSE(std::isfinite(stayed.summary.loss));
  for (const auto& [name, verified] : stayed.verified) EXPECT_EQ(verified, false) << name;
  EXPECT_EQ(hits_of(stayed), 0U);
  EXPECT_EQ(stayed.status, Status::diverged);
}

// Infinity at most infinity says nothing: neither of the loss, nor of the x that is sought.
TEST(Escapes, WithAnInfiniteScaleVerifyAndFindNothing) {
  Trace trace;
  trace.points = 1;
  trace.status = Status::converged;
  trace.minimum = 0;
  trace.last.loss = trace.last.x_error = 1;
  trace.scale = trace.x_scale = kInfinity;
  const Request request = jump_on("wall", 0, true);
  for (const Real error : {Real{1}, kInfinity}) {
    trace.last.x_error = error;
    const Record record = record_of(request, trace);
    for (const auto& [name, verified] : record.verified) EXPECT_EQ(verified, false) << name;
    for (const auto& [name, found] : record.found) EXPECT_EQ(found, false) << name;
  }
}

// --- Moré, Garbow and Hillstrom's problems from their standard starts, by Levenberg-Marquardt:
// Ceres' and ours. Solved: f = Σr² = 2L ≤ f* (1 + 1e-6) where f* > 0, else f ≤ 1e-12. A candidate
// is a point at which the residuals were evaluated.

const std::vector<std::string> kZeroResidual = {
    "rosenbrock",     "powell-singular",     "beale",
    "helical-valley", "brown-badly-scaled",  "box3d",
    "wood",           "broyden-tridiagonal", "variably-dimensioned"};

// τ for which f_L + τ (f₀ − f_L) is the loss of the criterion.
Real target_of(const Problem& problem) {
  Point at;
  problem.forward(problem.start(), at);
  const Real least = problem.minimum().value();
  const Real allowed = least > 0 ? 1e-6 * least : 0.5e-12;
  return allowed / (at.loss - least);
}

// Candidates until the problem was solved; infinite where it was not.
Real candidates(const std::string& name, const std::string& optimizer, std::int64_t most = 20000) {
  constexpr std::int64_t kAnyWork = 10000000;  // counted in candidates here, not in work
  Request request = cell_of(name, optimizer, {.iterations = most, .work = kAnyWork});
  request.budget.target = target_of(make_problem(catalog(), request.problem, 0));
  const Record record = executed(catalog(), named(request));
  const auto forwards = static_cast<Real>(record.counts[static_cast<int>(Oracle::forward)]);
  const bool is_solved = record.status == Status::target && forwards <= static_cast<Real>(most);
  return is_solved ? forwards : kInfinity;
}

TEST(ClassicalProblems, AreSolvedByCeresAndByOursWhichNeedsAsFewCandidates) {
  Real logarithms = 0;
  for (const std::string& name : kZeroResidual) {
    const Real ours = candidates(name, "levenberg-marquardt", 2000),
               theirs = candidates(name, "ceres-lm", 2000);
    EXPECT_LE(ours, 2000) << name;
    EXPECT_LE(theirs, 2000) << name;
    logarithms += std::log(ours / theirs);
    RecordProperty(name, std::to_string(ours) + " / " + std::to_string(theirs));
  }
  const Real mean = std::exp(logarithms / static_cast<Real>(kZeroResidual.size()));
  EXPECT_LE(mean, 1.1) << "geometric mean of ours / Ceres";
  EXPECT_LE(candidates("brown-dennis", "ceres-lm"), 20000);
  EXPECT_LE(candidates("brown-dennis", "levenberg-marquardt"), 500);
}

// A point has the loss that a newly made problem computes, whatever its cell did to its own
// problem.

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
      judges.ask(slot, request, limits, {});
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
  EXPECT_NE(record.message.find("its loss is 90 "), std::string::npos) << record.message;
  for (const auto& [tau, is_verified] : record.verified) EXPECT_EQ(is_verified, false) << tau;
}

TEST_F(Judging, AnHonestPointStands) {
  EXPECT_EQ(record_after(asked("square", {}, "cheat", {})).status, Status::unconfirmed);
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
  EXPECT_TRUE(verdict.failure.ends_with("more than 0.2 s")) << verdict.failure;
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
