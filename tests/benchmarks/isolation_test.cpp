// A cell that misbehaves costs that cell alone, and its record says what happened.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "benchmarks/run/isolate.h"
#include "benchmarks/run/run_plan.h"
#include "tests/benchmarks/hostile_cells.h"
#include "tests/deadline.h"

namespace isoline::benchmarks {
namespace {

class Isolation : public HostileCells {};

TEST_F(Isolation, AnExceptionIsAFailureWithItsText) {
  const Record record = record_after("throw");
  EXPECT_EQ(record.status, Status::failed);
  EXPECT_EQ(record.message, "thrown on purpose");
}

TEST_F(Isolation, AnythingThrownIsAFailure) {
  EXPECT_EQ(record_after("throw-int").status, Status::failed);
}

TEST_F(Isolation, ASegmentationFaultIsACrashAndItsTraceIsKept) {
  const Record record = record_after("segfault");
  EXPECT_EQ(record.status, Status::crashed);
  EXPECT_EQ(record.curve.iteration, (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_LT(record.curve.loss[2], record.curve.loss[0]);
  EXPECT_EQ(record.verified.at("1e-1"), std::optional(false));
}

TEST_F(Isolation, AnAbortIsACrash) {
  const Record record = record_after("abort");
  EXPECT_EQ(record.status, Status::crashed);
  EXPECT_EQ(record.curve.iteration.size(), 3U);
}

TEST_F(Isolation, LeavingWithoutAVerdictIsACrash) {
  EXPECT_EQ(record_after("exit").status, Status::crashed);
}

TEST_F(Isolation, NotANumberDiverges) {
  const Record record = record_after("nan");
  EXPECT_EQ(record.status, Status::diverged);
  EXPECT_TRUE(std::isnan(record.summary.loss));
}

TEST_F(Isolation, AskingForAnOracleNotDeclaredIsAFailure) {
  const Record record = record_after("overask");
  EXPECT_EQ(record.status, Status::failed);
  EXPECT_NE(record.message.find("jacobian"), std::string::npos);
}

TEST_F(Isolation, AnEndlessLoopIsKilledAndItsTraceIsKept) {
  const Record record = record_after("spin");
  EXPECT_EQ(record.status, Status::timeout);
  EXPECT_EQ(record.curve.iteration.size(), 3U);
  EXPECT_TRUE(record.is_nondeterministic);
}

TEST_F(Isolation, ARunawayAllocationIsOutOfMemory) {
  options.limits.hard_seconds = 30;  // touching half a gigabyte may take a while on a busy machine
  EXPECT_EQ(record_after("hoard").status, Status::memory);
}

TEST_F(Isolation, AProblemThatHangsBeforeItsFirstOracleIsKilled) {
  const Request request = request_for(catalog, "broken", {}, "gd", {});
  run_all(catalog, {request}, store, options);
  const Record record = record_of(request);
  EXPECT_EQ(record.status, Status::timeout);
  EXPECT_NE(record.message.find("without an oracle call"), std::string::npos);
}

TEST_F(Isolation, AProblemThatCrashesCostsItsCellAlone) {
  const Request broken = request_for(catalog, "broken", {{"misdeed", "segfault"}}, "gd", {});
  const Request sound = request_for(catalog, "square", {}, "gd", {});
  const Outcome outcome = run_all(catalog, {broken, sound}, store, options);
  EXPECT_EQ(outcome.failures.size(), 1U);
  EXPECT_EQ(record_of(broken).status, Status::crashed);
  EXPECT_EQ(record_of(sound).status, Status::budget);
}

TEST_F(Isolation, OtherCellsAreUntouchedByTheirNeighbours) {
  const Request sound = request_for(catalog, "square", {}, "gd", {});
  run_all(catalog, {sound}, store, options);
  const Json alone = without_timings(to_json(record_of(sound)));
  std::vector<Request> all;
  for (const char* misdeed : {"segfault", "throw", "nan", "abort"})
    all.push_back(request_for(catalog, "square", {}, "hostile", {{"misdeed", misdeed}}));
  all.push_back(sound);
  options.jobs = 2;
  options.force = true;
  const Outcome outcome = run_all(catalog, all, store, options);
  EXPECT_EQ(outcome.run, 5);
  EXPECT_EQ(without_timings(to_json(record_of(sound))), alone);
}

// Three numbers written over two would be read past their end.
TEST_F(Isolation, AMethodThatChangesTheNumberOfUnknownsFails) {
  const Record record = record_after("resize");
  EXPECT_EQ(record.status, Status::failed);
  EXPECT_NE(record.message.find("from 2 to 1002"), std::string::npos) << record.message;
  EXPECT_EQ(record.verified.at("1e-1"), std::optional(false));
}

TEST_F(Isolation, AProblemThatLeavesWhileItIsMadeCostsItsCellAlone) {
  const Request broken = request_for(catalog, "broken", {{"misdeed", "exit"}}, "gd", {});
  const Request sound = request_for(catalog, "square", {}, "gd", {});
  run_plan(catalog, "both", {broken, sound}, folder.path(), options);
  EXPECT_EQ(record_of(broken).status, Status::crashed);
  EXPECT_EQ(record_of(sound).status, Status::budget);
}

// --- What a cell prints: caught, bounded, kept where that is asked for.

class Output : public HostileCells {
 protected:
  Output() { options.limits.hard_seconds = 30; }
};

TEST_F(Output, OfACellReachesNoTerminalAndNoRecord) {
  testing::internal::CaptureStdout();
  const Record record = record_after("chatter");  // 20,000 lines with escape sequences
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(record.status, Status::budget) << record.message;
  EXPECT_EQ(record.output, "");
}

TEST_F(Output, IsKeptOnRequestUpToItsBound) {
  options.keeps_output = true;
  const Record record = record_after("chatter");
  EXPECT_TRUE(record.output.starts_with("\x1b[31mI write what nobody asked for\n"));
  EXPECT_GE(record.output.size(), CapturedOutput::kMost);
  EXPECT_LT(record.output.size(), CapturedOutput::kMost + 100);
  EXPECT_NE(record.output.find("bytes more"), std::string::npos) << "it says what was left out";
  EXPECT_FALSE(without_timings(to_json(record)).contains("output")) << "it is no result";
}

TEST_F(Output, OfACrashGivesItsLastWords) {
  const Record record = record_after("complain");
  EXPECT_EQ(record.status, Status::crashed);
  EXPECT_EQ(record.output, "the grid is too coarse");
}

// Whoever writes more than a pipe holds waits for nobody.
TEST_F(Output, WithoutEndHoldsNobodyUp) {
  const auto worker = ended_worker([](Trace& trace) {
    const std::string line(1000, 'x');
    for (int i = 0; i < 30'000; ++i) std::puts(line.c_str());
    trace.status = Status::budget;
  });
  EXPECT_EQ(worker->trace().status, Status::budget) << worker->trace().message;
  EXPECT_LT(worker->output().text().size(), CapturedOutput::kMost + 100);
}

TEST_F(Output, IsWhatWasWrittenInTheRightOrder) {
  const auto worker = ended_worker([](Trace& trace) {
    std::printf("first\n");
    std::fprintf(stderr, "second\n");
    std::printf("third, without an end");
    trace.status = Status::budget;
  });
  EXPECT_EQ(worker->output().text(), "first\nsecond\nthird, without an end");
}

TEST_F(Output, ThatIsNoTextBecomesText) {
  const auto worker = ended_worker([](Trace&) { std::printf("a\xff z"); });
  EXPECT_EQ(worker->output().text(), "a\uFFFD z");
}

TEST_F(Output, InputIsEmpty) {
  const auto worker = ended_worker(
      [](Trace& trace) { trace.status = getchar() == EOF ? Status::budget : Status::failed; });
  EXPECT_EQ(worker->trace().status, Status::budget);
}

}  // namespace
}  // namespace isoline::benchmarks
