// A cell may write anything over the memory that it shares: nothing of it is read unless it can be.
#include <gtest/gtest.h>

#include <cstring>

#include "benchmarks/run/execute.h"
#include "benchmarks/run/isolate.h"
#include "tests/benchmarks/builtin.h"
#include "tests/deadline.h"

namespace isoline::benchmarks {
namespace {

Request square_by_gd() { return cell_of("square", "gd", {.iterations = 20}); }

// Of a cell that ran as it should, and then wrote to its trace.
Record record_after(const std::function<void(Trace&)>& wild_write) {
  const Request request = square_by_gd();
  Worker worker;
  worker.start(
      [&](Trace& trace) {
        execute(catalog(), request, trace);
        wild_write(trace);
      },
      {}, 1);
  wait_until([&] { return worker.poll(); });
  return record_of(request, worker.trace());
}

TEST(BadTrace, OfASoundCellIsNone) {
  const Record record = record_after([](Trace&) {});
  EXPECT_EQ(record.status, Status::budget) << record.message;
  EXPECT_EQ(record.curve.iteration.size(), 21U);
}

TEST(BadTrace, OfAnyKindIsACrashThatSaysSo) {
  const std::vector<std::function<void(Trace&)>> writes = {
      [](Trace& trace) { trace.points = 1'000'000'000; },
      [](Trace& trace) { trace.points = -1; },
      [](Trace& trace) { trace.shown_x.rows = trace.shown_x.columns = 1 << 30; },
      [](Trace& trace) { trace.shown_x.rows = -(trace.shown_x.columns = -7); },
      [](Trace& trace) { trace.frames.rows = trace.frames.columns = 1 << 20; },
      [](Trace& trace) { std::memset(&trace.frames.has_truth, 0x5a, 1); },
      [](Trace& trace) { trace.frames.iteration[3] = trace.frames.iteration[4] = 7; },
      [](Trace& trace) { trace.spectra.values = 1 << 30; },
      [](Trace& trace) { trace.spectra.taken = -1; },
      [](Trace& trace) { std::memset(&trace.spectra.are_wanted, 0x5a, 1); },
      [](Trace& trace) { trace.path_inputs = 1 << 30; },
      [](Trace& trace) { trace.path_outputs = -1; },
      [](Trace& trace) { trace.status = static_cast<Status>(77); },
      [](Trace& trace) { trace.aim = static_cast<Aim>(-1); },
      [](Trace& trace) { std::memset(trace.message, 'x', sizeof trace.message); },
      [](Trace& trace) { std::memset(trace.privileges, 'x', sizeof trace.privileges); },
      [](Trace& trace) { std::memset(trace.claimed, 'x', sizeof trace.claimed); },
      [](Trace& trace) { std::memset(trace.series_names, '\n', 900); },
      [](Trace& trace) { set_text(trace.series_names, "a\na"); },
      [](Trace& trace) { trace.point[3].iteration = 1; },
      [](Trace& trace) { trace.point[3].counts[0] = -4; },
      [](Trace& trace) { trace.point[3].wall_seconds = -1; },
      [](Trace& trace) {
        trace.hit[0].iteration = std::int64_t{1} << 40;
        trace.hit[1].iteration = 5;
      },
      [](Trace& trace) { trace.rejected_steps = -1; },
      [](Trace& trace) { std::memset(&trace.is_learned, 0x5a, 1); },
      [](Trace& trace) { std::memset(static_cast<void*>(&trace.point), 0x5a, sizeof trace.point); },
      [](Trace& trace) { std::memset(static_cast<void*>(&trace), 0xff, sizeof trace); }};
  for (std::size_t i = 0; i < writes.size(); ++i) {
    const Record record = record_after(writes[i]);
    EXPECT_EQ(record.status, Status::crashed) << i;
    EXPECT_NE(record.message.find("overwrote the trace"), std::string::npos) << record.message;
    EXPECT_TRUE(record.curve.iteration.empty()) << i;
  }
}

TEST(BadTrace, OfARunThatWasKilledIsNotReadEither) {
  const Request request = square_by_gd();
  Worker worker;
  worker.start(
      [&](Trace& trace) {
        execute(catalog(), request, trace);
        trace.points = 1'000'000'000;
        for (volatile bool go_on = true; go_on;) {
        }
      },
      {.hard_seconds = 0.2}, 1);
  wait_until([&] { return worker.poll(); });
  const Record record = record_of(request, worker.trace());
  EXPECT_EQ(record.status, Status::timeout) << record.message;
  EXPECT_TRUE(record.curve.iteration.empty());
}

TEST(BadTrace, OfOneCellDoesNotReachTheMemoryOfAnother) {
  Worker first, second;
  first.start([](Trace& trace) { trace.status = Status::budget; }, {}, 1);
  wait_until([&] { return first.poll(); });
  const Trace& other = first.trace();
  second.start(
      [&](Trace&) {
        std::memset(static_cast<void*>(const_cast<Trace*>(&other)), 0x5a, sizeof(Trace));
      },
      {}, 1);
  wait_until([&] { return second.poll(); });
  EXPECT_EQ(second.trace().status, Status::crashed) << second.trace().message;
  EXPECT_EQ(first.trace().status, Status::budget);
}

TEST(BadTrace, OfASizeThatCannotBeReturnsNothing) {
  Worker worker;
  const auto sizes_after = [&](std::int64_t size) {
    worker.start(
        [&](Trace& trace) {
          worker.keep_returned(std::vector<Real>(3, 7));
          const_cast<Returned*>(reinterpret_cast<const Returned*>(worker.returned() - 1))->size =
              size;
          trace.status = Status::budget;
        },
        {}, 1);
    wait_until([&] { return worker.poll(); });
    return worker.returned_size();
  };
  static_assert(offsetof(Returned, theta) == sizeof(double));
  EXPECT_EQ(sizes_after(3), 3);
  EXPECT_EQ(worker.returned()[2], 7);
  EXPECT_EQ(sizes_after(-3), 0);
  EXPECT_EQ(sizes_after(std::int64_t{1} << 40), 0);
}

TEST(BadTrace, TextIsCutAtACharacter) {
  Trace trace;
  std::string text(Trace::kText - 2, 'x');
  text += "→ and on";  // three bytes, of which one would fit
  set_text(trace.message, text);
  EXPECT_EQ(trace.message, std::string(Trace::kText - 2, 'x'));
}

}  // namespace
}  // namespace isoline::benchmarks
