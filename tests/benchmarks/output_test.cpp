// What a cell prints: caught, bounded, kept where that is asked for.
#include <nlohmann/json.hpp>

#include "benchmarks/run/isolate.h"
#include "tests/benchmarks/hostile_cells.h"
#include "tests/deadline.h"

namespace isoline::benchmarks {
namespace {

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
  Worker worker;
  worker.start(
      [](Trace& trace) {
        const std::string line(1000, 'x');
        for (int i = 0; i < 30'000; ++i) std::puts(line.c_str());
        trace.status = Status::budget;
      },
      {}, 1);
  wait_until([&] { return worker.poll(); });
  EXPECT_EQ(worker.trace().status, Status::budget) << worker.trace().message;
  EXPECT_LT(worker.output().text().size(), CapturedOutput::kMost + 100);
}

TEST_F(Output, IsWhatWasWrittenInTheRightOrder) {
  Worker worker;
  worker.start(
      [](Trace& trace) {
        std::printf("first\n");
        std::fprintf(stderr, "second\n");
        std::printf("third, without an end");
        trace.status = Status::budget;
      },
      {}, 1);
  wait_until([&] { return worker.poll(); });
  EXPECT_EQ(worker.output().text(), "first\nsecond\nthird, without an end");
}

TEST_F(Output, ThatIsNoTextBecomesText) {
  Worker worker;
  worker.start([](Trace&) { std::printf("a\xff z"); }, {}, 1);
  wait_until([&] { return worker.poll(); });
  EXPECT_EQ(worker.output().text(), "a\uFFFD z");
}

TEST_F(Output, InputIsEmpty) {
  Worker worker;
  worker.start(
      [](Trace& trace) { trace.status = getchar() == EOF ? Status::budget : Status::failed; }, {},
      1);
  wait_until([&] { return worker.poll(); });
  EXPECT_EQ(worker.trace().status, Status::budget);
}

}  // namespace
}  // namespace isoline::benchmarks
