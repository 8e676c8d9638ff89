// What a cell starts is part of the cell: it counts, and it ends with it.
#include <sys/wait.h>

#include "benchmarks/run/isolate.h"
#include "tests/benchmarks/hostile_cells.h"
#include "tests/deadline.h"

namespace isoline::benchmarks {
namespace {

class Descendants : public HostileCells {
 protected:
  Descendants() {  // what runs that other tests killed left to this process is dead by now
    wait_until([] {
      while (waitpid(-1, nullptr, WNOHANG) > 0) {
      }
      return children_of(getpid()).empty();
    });
  }
  static void expect_good_end(Worker& worker) {
    wait_until([&] { return worker.poll(); });
    EXPECT_EQ(worker.trace().status, Status::budget) << worker.trace().message;
  }
};

TEST_F(Descendants, ThatWentToASessionOfTheirOwnEndWithTheirCell) {
  options.limits.hard_seconds = 30;
  const Record record = record_after("daemon");
  EXPECT_EQ(record.status, Status::budget) << record.message;
  ASSERT_GT(told(), 0) << "no daemon was started";
  EXPECT_FALSE(lives(told()));
}

TEST_F(Descendants, OfAnotherCellAreLeftAlone) {
  Worker first, second;
  const auto spin = [](Trace& trace) {
    trace.first_oracle_nanoseconds = 1;
    leave_a_daemon_behind();
    for (;;) pause();
  };
  first.start(spin, {}, 1);
  wait_until([] { return told() != 0; });
  second.start([](Trace& trace) { trace.status = Status::budget; }, {}, 1);
  wait_until([&] { return second.poll(); });
  EXPECT_TRUE(lives(told())) << "it belongs to the first, which runs";
  first.interrupt();
  EXPECT_FALSE(lives(told()));
}

TEST_F(Descendants, CountForTheMemoryOfTheirCell) {
  options.limits.hard_seconds = 30;
  const Record record = record_after("crowd");  // three of 300 MiB, each below 512
  EXPECT_EQ(record.status, Status::memory) << record.message;
  EXPECT_TRUE(children_of(getpid()).empty());
}

// A page that many share is one page.
TEST_F(Descendants, DoNotCountWhatTheyShareTwice) {
  Worker worker;
  constexpr std::size_t kSize = std::size_t{200} << 20;
  worker.start(
      [](Trace& trace) {
        const std::vector<char> shared(kSize, 1);
        for (int i = 0; i < 3; ++i)
          if (fork() == 0)
            for (;;) pause();
        trace.first_oracle_nanoseconds = 1;
        trace.status = Status::budget;
        usleep(500'000);
      },
      {.memory_bytes = std::int64_t{512} << 20}, 1);
  expect_good_end(worker);
  EXPECT_TRUE(children_of(getpid()).empty());
}

// Four processes in a row, each the child of the one before and in a session of its own.
TEST_F(Descendants, OfDescendantsEndToo) {
  Worker worker;
  worker.start(
      [](Trace& trace) {
        for (int i = 0; i < 4; ++i) {
          if (fork() == 0) {
            setsid();
            ++told();
            continue;
          }
          if (i > 0)
            for (;;) pause();
          wait_until([] { return told() >= 4; });
          trace.status = Status::budget;
          return;
        }
        for (;;) pause();
      },
      {}, 1);
  expect_good_end(worker);
  EXPECT_TRUE(children_of(getpid()).empty());
}

// A comet: every process starts the next in a session of its own, and ends.
TEST_F(Descendants, ThatNeverStandStillEndToo) {
  Worker worker;
  worker.start(
      [](Trace& trace) {
        if (fork() == 0) {
          setsid();
          for (;;) {
            if (fork() != 0) _exit(0);
            setsid();
            ++told();
          }
        }
        wait_until([] { return told() >= 100; });
        trace.status = Status::budget;
      },
      {}, 1);
  expect_good_end(worker);
  const int last = told();
  usleep(100'000);
  EXPECT_EQ(told(), last) << "it flies on";
  EXPECT_TRUE(children_of(getpid()).empty());
}

TEST_F(Descendants, SpendTheProcessorTimeOfTheirCell) {
  Worker worker;
  worker.start(
      [](Trace& trace) {
        trace.first_oracle_nanoseconds = 1;
        if (fork() == 0)
          for (volatile bool go_on = true; go_on;) {
          }
        for (;;) pause();
      },
      {.hard_seconds = 0.3}, 1);
  wait_until([&] { return worker.poll(); });
  EXPECT_EQ(worker.trace().status, Status::timeout) << worker.trace().message;
  EXPECT_NE(std::string(worker.trace().message).find("processor time"), std::string::npos)
      << worker.trace().message;
}

}  // namespace
}  // namespace isoline::benchmarks
